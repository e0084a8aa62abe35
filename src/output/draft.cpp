#include "src/output/draft.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "src/output/leftovers.h"
#include "src/scene/input_error.h"

namespace exitance {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".part";

// What a link leads to; nothing where that is an open file, of which /proc has only the number.
std::optional<fs::path> end_of_links(fs::path path) {
  constexpr int kMostLinks = 40;  // as the system allows
  std::error_code failed;
  for (int k = 0; k < kMostLinks && fs::is_symlink(path, failed); ++k) {
    const fs::path folder = path.parent_path();
    const fs::path real_folder = fs::canonical(folder.empty() ? "." : folder, failed);
    if (failed) break;
    if (real_folder.native().starts_with("/proc/")) return std::nullopt;
    const fs::path to = fs::read_symlink(path, failed);
    if (failed) break;
    path = folder / to;
  }
  return path;
}

bool can_be_replaced(const fs::path& path) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  return !fs::exists(status) || fs::is_regular_file(status) || fs::is_directory(status);
}

// 0, or the error. Some file systems cannot do it for folders (EINVAL), where a rename is as safe as it gets.
int to_disk(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return errno;
  const int error = fsync(file) == 0 || errno == EINVAL ? 0 : errno;
  close(file);
  return error;
}

}  // namespace

Draft::Draft(const fs::path& path) : path_(path), beside_(path) {
  const std::optional<fs::path> target = end_of_links(path);
  is_direct_ = !target || !can_be_replaced(path);
  if (is_direct_) return;
  path_ = beside_ = *target;
  std::error_code failed;
  if (fs::is_directory(path_, failed)) refuse("it is a folder");
  if (failed.value() == ELOOP) refuse(failed.message());
  beside_ += '.';
  remove_leftovers(folder(), beside_.filename().native(), kSuffix);
  beside_ += name_of_process(getpid());
  beside_ += kSuffix;
}

Draft::~Draft() {
  if (is_direct_) return;
  std::error_code ignored;
  fs::remove(beside_, ignored);
}

void Draft::publish() const {
  if (is_direct_) return;
  if (const int error = to_disk(beside_)) refuse(std::strerror(error));
  std::error_code failed;
  fs::rename(beside_, path_, failed);
  if (failed) refuse(failed.message());
  if (const int error = to_disk(folder())) refuse(std::strerror(error));
}

fs::path Draft::folder() const {
  return path_.has_parent_path() ? path_.parent_path() : ".";
}

void Draft::refuse(const std::string& why) const {
  throw InputError(path_.string(), 0, "cannot be written (" + why + "); choose a folder that exists and is writable");
}

}  // namespace exitance
