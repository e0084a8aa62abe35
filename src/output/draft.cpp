#include "src/output/draft.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "src/scene/input_error.h"

namespace exitance {
namespace {

// 0, or the error. Some file systems cannot do it for folders (EINVAL), where a rename is as safe as it gets.
int to_disk(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return errno;
  const int error = fsync(file) == 0 || errno == EINVAL ? 0 : errno;
  close(file);
  return error;
}

}  // namespace

Draft::Draft(std::filesystem::path path) : path_(std::move(path)), beside_(path_) {
  beside_ += '.';
  beside_ += std::to_string(getpid());
  beside_ += ".part";
}

Draft::~Draft() {
  std::error_code ignored;
  std::filesystem::remove(beside_, ignored);
}

void Draft::publish() const {
  if (const int error = to_disk(beside_)) refuse(std::strerror(error));
  std::error_code failed;
  std::filesystem::rename(beside_, path_, failed);
  if (failed) refuse(failed.message());
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  if (const int error = to_disk(folder)) refuse(std::strerror(error));
}

void Draft::refuse(const std::string& why) const {
  throw InputError(path_.string(), 0, "cannot be written (" + why + "); choose a folder that exists and is writable");
}

}  // namespace exitance
