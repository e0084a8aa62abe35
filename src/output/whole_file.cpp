#include "src/output/whole_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "src/output/draft.h"

namespace exitance {

void write_whole_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write) {
  const Draft draft(path);
  errno = 0;
  // Of a file that is written directly, what stands there already is not ours.
  std::ofstream stream(draft.path(), std::ios::binary | (draft.is_direct() ? std::ios::app : std::ios::trunc));
  if (!stream) draft.refuse(std::strerror(errno));
  write(stream);
  errno = 0;
  stream.close();
  if (!stream) draft.refuse(errno != 0 ? std::strerror(errno) : "the disk may be full");
  draft.publish();
}

}  // namespace exitance
