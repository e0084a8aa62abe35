#pragma once
// What a version of a scene converges to, and how far a solution is from that.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "src/dynamic/dynamic_radiosity.h"
#include "src/dynamic/edit_session.h"
#include "src/solve/convergence_error.h"

namespace exitance {

/// B by element and band of the present scene, solved by gathering to 1e-13 of max B from all columns of form factors,
/// computed anew; nothing of what has been shot is used. 0 where an element is not there. In parallel; any number of
/// threads gives the same bits.
std::vector<double> converged_reference(const DynamicRadiosity& state);

/// Converged solutions of one session's frames: by gathering, or, where the form factors of the first frame would not
/// fit in memory, by a session of its own that redistributes and works off everything to `tolerance`.
class FrameReferences {
 public:
  /// scene: as the session begins; memory: for form factors [bytes].
  FrameReferences(const Scene& scene, const SessionOptions& options, const DynamicRadiosity& state,
                  std::uint64_t memory, double tolerance = 1e-4);

  bool gathers() const { return !session_; }

  /// Each edit of the session is to be told here, too.
  void apply(const Edit& edit);

  /// B by element and band of the present frame, that of the session's solution; none where `stop`, asked after every
  /// shot, came first.
  std::optional<std::vector<double>> find(const DynamicRadiosity& state, const std::function<bool()>& stop);

  /// As EditSession's: gathering has nothing to keep.
  void write(ArchiveWriter& file, const std::string& prefix) const;
  static FrameReferences taken_up(const Scene& scene, const SessionOptions& options, std::span<const Edit> edits,
                                  const ArchiveReader& file, const std::string& prefix, double tolerance = 1e-4);

 private:
  FrameReferences() = default;

  std::optional<EditSession> session_;
};

/// Equation 7 over the elements that are there.
ConvergenceError convergence_error(const SceneVersion& version, std::uint32_t bands,
                                   const std::vector<double>& reference, const std::vector<double>& was,
                                   const std::vector<double>& current);

}  // namespace exitance
