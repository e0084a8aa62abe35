#include "src/output/whole_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "src/scene/input_error.h"

namespace exitance {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw InputError(path.string(), 0, "cannot be written (" + why + "); choose a folder that exists and is writable");
}

// Removes the file, which is no longer there once it was renamed.
struct Draft {
  std::filesystem::path path;
  ~Draft() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

}  // namespace

void write_whole_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write) {
  std::filesystem::path beside = path;
  beside += '.';
  beside += std::to_string(getpid());
  beside += ".part";
  errno = 0;
  std::ofstream stream(beside, std::ios::binary | std::ios::trunc);
  if (!stream) refuse(path, std::strerror(errno));
  const Draft draft{beside};
  write(stream);
  errno = 0;
  stream.close();
  if (!stream) refuse(path, errno != 0 ? std::strerror(errno) : "the disk may be full");
  std::error_code failed;
  std::filesystem::rename(beside, path, failed);
  if (failed) refuse(path, failed.message());
}

}  // namespace exitance
