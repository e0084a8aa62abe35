#pragma once
// A folder of results that belong together.

#include <filesystem>
#include <vector>

namespace exitance {

/// Results are written into a draft folder within the folder and moved out of it, replacing earlier ones, when all that
/// belongs together is there. What is not published is removed, and so are folders that were made for nothing and the
/// drafts that killed processes of this host have left (leftovers.h).
class ResultFolder {
 public:
  /// Makes the folder (and its parents) and the draft in it, so that a long piece of work fails at its start when its
  /// results could not be written. Throws InputError.
  explicit ResultFolder(std::filesystem::path folder);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  const std::filesystem::path& draft() const { return draft_; }

  /// In the folder, while there is more to do: what a run keeps to go on with (checkpoint.h).
  static constexpr const char* kUnfinished = "unfinished.parts";

  /// Moves every file that is in the draft now into the folder, in place of earlier ones and of links. Throws
  /// InputError when a folder stands where a file is to go, before anything is moved, and when the system refuses.
  void publish() const;

 private:
  void remove_draft() const;  ///< and the folders that were made for it, unless something is in them

  std::filesystem::path folder_, draft_;
  std::vector<std::filesystem::path> made_;  ///< by us, the innermost first
};

}  // namespace exitance
