#pragma once
// Checkpoints: what a long run has finished, so that it can be ended at any moment and go on.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "src/output/archive.h"

namespace exitance {

/// A folder of archives, one for each time that something was added. It belongs to one process at a time, and to one
/// thread of it.
class Checkpoint {
 public:
  /// What becomes of what another run, whose key differs, has left there.
  enum class OtherRun : std::uint8_t {
    refused,   ///< it stays: `open` throws
    forgotten  ///< it is removed: all parts as soon as one of them is another's or cannot be opened
  };

  /// Opens the folder, or makes it. key: everything the parts depend on (mesh hash, tolerance, options, version), one
  /// "name value" a line. Drafts of a process that was killed are removed. Throws InputError when the folder cannot be
  /// made or another process works in it.
  Checkpoint(std::filesystem::path folder, std::string key, OtherRun other = OtherRun::refused);
  /// Removes a folder in which nothing was kept.
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  /// Whether parts were found there that `forgotten` removed.
  bool has_forgotten() const { return has_forgotten_; }
  std::string what_was_forgotten() const;  ///< to be said then

  /// What was added so far, in the order in which it was.
  const std::vector<std::filesystem::path>& parts() const { return parts_; }

  /// Throws DamagedFile for a damaged file (to be removed: what it held is computed again), InputError for one of a run
  /// with another key, naming what differs.
  ArchiveReader open(const std::filesystem::path& part) const;

  /// Has `read` read the part that was added last; one that is damaged is forgotten, and the one before it read. False
  /// where none is left: `read` may have begun then. Throws what `read` throws, but for DamagedFile.
  bool read_last(const std::function<void(const ArchiveReader&)>& read);

  /// Has `write` fill another part; "key" is taken. When it returns all is on the disk: only then may it be reported as
  /// finished. A file and a wait for the disk each time, so better every few seconds. Throws InputError when the system
  /// refuses.
  void add(const std::function<void(ArchiveWriter&)>& write);

  /// Whether damage is no reason to stop: what cannot be read is forgotten and made anew.
  bool forgets() const { return other_ == OtherRun::forgotten; }

  /// Removes one of the parts, which cannot be used.
  void forget(const std::filesystem::path& part);

  /// Like `add`, of a part that stands for all before it, which are removed.
  void replace(const std::function<void(ArchiveWriter&)>& write);

  /// Removes the checkpoint: the run is complete and its result saved. The folder stays if it holds other files.
  void remove();

 private:
  // An open folder that no other process may lock.
  class Lock {
   public:
    explicit Lock(const std::filesystem::path& folder);
    ~Lock();
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

   private:
    int folder_ = -1;
  };

  bool is_sound(const std::filesystem::path& part) const;
  void remove_first(std::size_t count);

  std::filesystem::path folder_;
  std::string key_;
  OtherRun other_;
  Lock lock_;
  std::vector<std::filesystem::path> parts_;  // in the order of their numbers
  std::uint64_t next_ = 1;                    // number of the next part
  bool has_forgotten_ = false;
  bool is_removed_ = false;  // then a folder of that name is another run's, though it may be empty
};

}  // namespace exitance
