#pragma once
// Checkpoints: what a long run over pairs of patches has finished, so that it can be ended at any moment and go on.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "src/form_factor/pair_rows.h"

namespace exitance {

/// A folder of archives, one for each time that rows were added. It belongs to one process at a time, and to one thread
/// of it.
class Checkpoint {
 public:
  /// Opens the folder, or makes it. key: everything the rows depend on (mesh hash, tolerance, options, version), one
  /// "name value" a line. Drafts of a process that was killed are removed. Throws InputError when the folder cannot be
  /// made or another process works in it.
  Checkpoint(std::filesystem::path folder, std::string key);
  /// All rows that were added so far, in the order in which they were. Throws DamagedFile for a damaged file (to be
  /// removed: its rows are computed again) and a row that is there twice, InputError for files of a run with another
  /// key, naming what differs.
  std::vector<PairRows> finished() const;

  /// Saves rows that were not added before. When it returns they are on the disk: only then may they be reported as
  /// finished. A file and a wait for the disk each time, so better every few seconds than every row. Throws
  /// std::invalid_argument when the sizes do not fit, InputError when the system refuses.
  void add(const PairRows& rows);

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

  std::filesystem::path folder_;
  std::string key_;
  Lock lock_;
  std::vector<std::filesystem::path> parts_;  // in the order of their numbers
  std::uint64_t next_ = 1;                    // number of the next part
};

}  // namespace exitance
