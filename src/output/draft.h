#pragma once
// A file while it is being written.

#include <filesystem>
#include <string>

namespace exitance {

/// The path beside `path` under which it is written. Removed at the end unless published. A link is followed: what it
/// leads to is replaced, though it may not be there yet, and the link stays. What cannot be replaced (a FIFO, a device,
/// a socket, an open file under /proc such as /dev/stdout) is written to directly. Drafts of the same file that killed
/// processes of this host have left are removed (leftovers.h).
class Draft {
 public:
  /// Throws InputError when a folder stands there.
  explicit Draft(const std::filesystem::path& path);
  ~Draft();
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  const std::filesystem::path& path() const { return beside_; }
  /// Whether path() is the file itself, which is to be written at its end.
  bool is_direct() const { return is_direct_; }

  /// Renames the draft, which has been closed, to what it is a draft of, in place of an earlier file of that name. It
  /// is on the disk then: neither a killed program nor a power failure takes it away. Throws InputError.
  void publish() const;

  /// Throws the InputError that says why the file cannot be written.
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  std::filesystem::path folder() const;

  std::filesystem::path path_, beside_;
  bool is_direct_ = false;
};

}  // namespace exitance
