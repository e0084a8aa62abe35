#pragma once
// Converged solutions of frames, kept from one run for others.

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "src/dynamic/converged_reference.h"

namespace exitance {

/// Solutions by what they are solutions of: bit for bit the same surfaces, materials, patches and sample points. Those
/// of a run are computed once; with a file those of earlier runs are found again.
class ReferenceStore {
 public:
  /// The file may not be there yet; empty: none. Throws InputError where it is something else, or cannot be made.
  explicit ReferenceStore(std::filesystem::path file);

  /// B by element and band of the present frame of a session: the one that is kept, or the references' own; none where
  /// `stop` came first. Throws InputError, before it looks for one that is not kept, where that could not be written.
  std::optional<std::vector<double>> find(const EditSession& session, FrameReferences& references,
                                          const std::function<bool()>& stop);

  /// Writes the file, if there is one to write and anything is new in it.
  void save();

 private:
  void refuse_unwritable() const;

  std::filesystem::path file_;
  std::map<std::string, std::vector<double>> kept_;
  bool is_new_ = false;
};

}  // namespace exitance
