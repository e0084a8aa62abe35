#include "src/reference/checkpoint.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "src/reference/archive.h"

namespace exitance {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kKind = "exitance rows of pairs 1";
constexpr std::string_view kPrefix = "rows-", kSuffix = ".h5";

// The number in "rows-<number>.h5".
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

bool fits(const PairRows& rows) {
  const std::size_t pairs = rows.column.size();
  return rows.row_first.size() == rows.row.size() + 1 && rows.row_first.front() == 0 &&
         rows.row_first.back() == pairs && std::ranges::is_sorted(rows.row_first) && rows.F.size() == pairs &&
         rows.F_error.size() == pairs && rows.F_reverse.size() == pairs && rows.F_reverse_error.size() == pairs &&
         rows.mark.size() == pairs;
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

PairRows read_part(const fs::path& path, const std::string& key) {
  const ArchiveReader file(path, kKind);
  if (const std::string found = file.text("key"); found != key) {
    throw InputError(
        path.string(), 0,
        fmt::format("belongs to another run ({}); finish that one, or remove its folder", difference(found, key)));
  }
  PairRows rows{.row = file.uint32s("row"),
                .row_first = file.uint64s("row_first"),
                .column = file.uint32s("column"),
                .F = file.doubles("F"),
                .F_error = file.doubles("F_error"),
                .F_reverse = file.doubles("F_reverse"),
                .F_reverse_error = file.doubles("F_reverse_error"),
                .mark = file.uint8s("mark")};
  if (!fits(rows)) file.refuse("its vectors do not fit each other");
  return rows;
}

}  // namespace

Checkpoint::Lock::Lock(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (!failed) folder_ = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
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

Checkpoint::Checkpoint(fs::path folder, std::string key)
    : folder_(std::move(folder)), key_(std::move(key)), lock_(folder_) {
  std::vector<std::pair<std::uint64_t, fs::path>> found;
  std::vector<fs::path> drafts;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    if (const auto number = part_number(name)) found.emplace_back(*number, entry.path());
    if (is_draft(name)) drafts.push_back(entry.path());
  }
  std::error_code ignored;
  for (const fs::path& draft : drafts) fs::remove(draft, ignored);
  std::ranges::sort(found);
  for (auto& [number, path] : found) {
    parts_.push_back(std::move(path));
    next_ = number + 1;
  }
}

std::vector<PairRows> Checkpoint::finished() const {
  std::vector<PairRows> all;
  std::set<std::uint32_t> seen;
  for (const fs::path& path : parts_) {
    all.push_back(read_part(path, key_));
    for (const std::uint32_t row : all.back().row) {
      if (!seen.insert(row).second)
        throw DamagedFile(path, fmt::format("holds row {}, which another file of its folder holds already", row));
    }
  }
  return all;
}

void Checkpoint::add(const PairRows& rows) {
  if (!fits(rows)) throw std::invalid_argument("Checkpoint::add: the vectors of the rows do not fit each other");
  const fs::path path = folder_ / fmt::format("{}{:06}{}", kPrefix, next_, kSuffix);
  ArchiveWriter file(path, kKind);
  file.write("key", key_);
  file.write("row", std::span(rows.row));
  file.write("row_first", std::span(rows.row_first));
  file.write("column", std::span(rows.column));
  file.write("F", std::span(rows.F));
  file.write("F_error", std::span(rows.F_error));
  file.write("F_reverse", std::span(rows.F_reverse));
  file.write("F_reverse_error", std::span(rows.F_reverse_error));
  file.write("mark", std::span(rows.mark));
  file.publish();
  parts_.push_back(path);
  ++next_;
}

void Checkpoint::remove() {
  std::error_code ignored;
  for (const fs::path& path : parts_) fs::remove(path, ignored);
  parts_.clear();
  fs::remove(folder_, ignored);
}

}  // namespace exitance
