#include "src/output/checkpoint.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

namespace exitance {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kKind = "exitance part of a run 1";
constexpr std::string_view kPrefix = "part-", kSuffix = ".h5";

// The number in "part-<number>.h5".
std::optional<std::uint64_t> part_number(const std::string& name) {
  if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return std::nullopt;
  const char *first = name.data() + kPrefix.size(), *last = name.data() + name.size() - kSuffix.size();
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(first, last, number);
  return error == std::errc() && end == last ? std::optional(number) : std::nullopt;
}

bool is_draft(const std::string& name) {
  return name.starts_with(kPrefix) && name.ends_with(".part");
}

// The first line that differs, as it is there and here.
std::string difference(const std::string& there, const std::string& here) {
  std::istringstream other(there), own(here);
  std::string a, b;
  do {
    if (!std::getline(other, a)) a.clear();
    if (!std::getline(own, b)) b.clear();
  } while (a == b && (other || own));
  return fmt::format("\"{}\" there, \"{}\" here", a, b);
}

}  // namespace

Checkpoint::Lock::Lock(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (!failed) folder_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder_ < 0) {
    throw InputError(folder.string(), 0,
                     fmt::format("a checkpoint cannot be kept there ({}); choose a folder that is writable",
                                 failed ? failed.message() : std::strerror(errno)));
  }
  // Where folders cannot be locked (some network drives) all is as it would be without.
  if (flock(folder_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    close(folder_);
    throw InputError(folder.string(), 0, "another run is working on it; wait for it, or write to another file");
  }
}

Checkpoint::Lock::~Lock() {
  close(folder_);
}

Checkpoint::Checkpoint(fs::path folder, std::string key, OtherRun other)
    : folder_(std::move(folder)), key_(std::move(key)), other_(other), lock_(folder_) {
  std::vector<std::pair<std::uint64_t, fs::path>> found;
  std::vector<fs::path> drafts;
  std::error_code failed, ignored;
  for (fs::directory_iterator entry(folder_, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (const auto number = part_number(name)) found.emplace_back(*number, entry->path());
    if (is_draft(name)) drafts.push_back(entry->path());
  }
  if (failed) throw InputError(folder_.string(), 0, fmt::format("cannot be read ({}); remove it", failed.message()));
  for (const fs::path& draft : drafts) fs::remove(draft, ignored);
  std::ranges::sort(found);
  for (auto& [number, path] : found) {
    parts_.push_back(std::move(path));
    next_ = number + 1;
  }
  if (forgets() && !std::ranges::all_of(parts_, [this](const fs::path& part) { return is_sound(part); })) {
    remove_first(parts_.size());
    has_forgotten_ = true;
  }
}

std::string Checkpoint::what_was_forgotten() const {
  return fmt::format("what was kept in {} was of other work, or damaged, and is removed", folder_.string());
}

bool Checkpoint::is_sound(const fs::path& part) const {
  try {
    open(part);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

ArchiveReader Checkpoint::open(const fs::path& part) const {
  ArchiveReader file(part, kKind);
  if (const std::string found = file.text("key"); found != key_) {
    throw InputError(
        part.string(), 0,
        fmt::format("belongs to another run ({}); finish that one, or remove its folder", difference(found, key_)));
  }
  return file;
}

bool Checkpoint::read_last(const std::function<void(const ArchiveReader&)>& read) {
  while (!parts_.empty()) {
    try {
      read(open(parts_.back()));
      return true;
    } catch (const DamagedFile&) {
      forget(parts_.back());
    }
  }
  return false;
}

void Checkpoint::add(const std::function<void(ArchiveWriter&)>& write) {
  const fs::path path = folder_ / fmt::format("{}{:06}{}", kPrefix, next_, kSuffix);
  ArchiveWriter file(path, kKind, Packing::quick);
  file.write("key", key_);
  write(file);
  file.publish();
  parts_.push_back(path);
  ++next_;
}

void Checkpoint::forget(const fs::path& part) {
  const fs::path path = part;  // it may be one of parts_ itself
  std::error_code ignored;
  fs::remove(path, ignored);
  std::erase(parts_, path);
}

void Checkpoint::replace(const std::function<void(ArchiveWriter&)>& write) {
  add(write);
  remove_first(parts_.size() - 1);
}

void Checkpoint::remove() {
  remove_first(parts_.size());
  std::error_code ignored;
  fs::remove(folder_, ignored);
  is_removed_ = true;
}

Checkpoint::~Checkpoint() {
  std::error_code ignored;
  if (!is_removed_ && parts_.empty()) fs::remove(folder_, ignored);
}

void Checkpoint::remove_first(std::size_t count) {
  std::error_code ignored;
  for (std::size_t k = 0; k < count; ++k) fs::remove(parts_[k], ignored);
  parts_.erase(parts_.begin(), parts_.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace exitance
