#pragma once
// A session of edits: in which order propagation and redistribution shots are made, within a budget, until new input
// comes (George, Sillion and Greenberg 1990, Figures 3 to 5).

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "src/dynamic/dynamic_radiosity.h"

namespace exitance {

/// What is done after an edit.
enum class UpdateMethod : std::uint8_t {
  scratch,  ///< progressive refinement from nothing
  restart,  ///< progressive refinement from the previous solution: without shadow volumes every patch's whole column
            ///< is computed by both versions, in order of all energy that it has shot
  redistribute  ///< redistribution
};

enum class Strategy : std::uint8_t {
  redistribute_first,  ///< one: down to the threshold, then as in two
  interleave           ///< two: always the larger of both
};

/// How the patches of the object that was edited get their redistribution terms, by UpdateMethod::redistribute.
enum class ObjectTerms : std::uint8_t {
  shot,  ///< by the redistribution shots of others (Figure 2)
  /// Each by itself, and shots then go to the shadows only: next is always the strongest redistribution shot or, where
  /// one of them gets more on the average, the next of them (of exact importance always: it needs the same form
  /// factors). Nothing else is propagated before all have.
  gathered
};

struct SessionOptions {
  MeshOptions mesh;
  UpdateMethod method = UpdateMethod::redistribute;
  Strategy strategy = Strategy::redistribute_first;
  /// Of strategy one: redistribution comes first while the next shot moves at least this share of the light sources'
  /// power, as it is ranked. 0: until nothing is left to redistribute.
  double threshold = 1e-4;
  ImportanceOptions importance;
  ObjectTerms object_terms = ObjectTerms::gathered;
  /// Without it what is interrupted by an edit is never redistributed, and B stays wrong by that, however long the
  /// session works (DynamicRadiosity::has_forgotten).
  bool log = true;
  double tolerance = 1e-6;  ///< of ‖B − B*‖∞ / max B, worst band: then there is nothing left to do; > 0
  std::uint64_t column_memory = DynamicRadiosity::kColumnMemory;  ///< for form factors that are kept [bytes]
};

/// What a stretch of work has done. The same shots, asked for as a budget, give the same bits again.
struct SessionWork {
  std::uint64_t propagations = 0, redistributions = 0;
  std::uint64_t gatherings = 0;  ///< of a patch each; a shot, too, where shots are counted
  double seconds = 0;
  ChangeWork propagation, redistribution, gathering;
  /// Nothing is left to do: B is within the tolerance, unless changes were forgotten (SessionOptions::log).
  bool finished = false;
  bool interrupted = false;  ///< by new input

  std::uint64_t shots() const { return propagations + redistributions + gatherings; }
};

/// How long to work. 0 is a budget, too: nothing is shot, and all that is to be redistributed stays in the log.
struct Budget {
  std::optional<std::uint64_t> shots;
  std::optional<double> seconds;
  /// Asked after every shot: true when there is new input. May be empty.
  std::function<bool()> interrupted;
  /// Told after every shot what has been done in this stretch: the time to keep it (EditSession::write), which counts as
  /// no work. May be empty.
  std::function<void(const SessionWork&)> after_shot;
};

class EditSession {
 public:
  EditSession(Scene scene, const SessionOptions& options);

  /// Goes on from where another session is, with other options; of the mesh they must be the same.
  EditSession(const EditSession& other, const SessionOptions& options);

  /// The solution as it is to be shown.
  const DynamicRadiosity& solution() const { return shown_ ? *shown_ : base_; }
  const EditedScene& scene() const { return scene_; }

  /// An edit. Nothing is shot yet. Throws InvalidEdit; the session goes on as it was.
  ///
  /// A selected object is taken out of the solution. While it is selected its edits are temporary: the solution with it
  /// is a copy of the one without, erased when the object changes again, so that any number of moves is in the end one
  /// removal and one addition. When it is let go the copy, as far as it has come, becomes the solution. Other objects
  /// cannot be edited meanwhile; selecting a second one lets the first go. From scratch there is nothing to hold.
  void apply(const Edit& edit);

  /// Works until the budget is used up, input comes or nothing is left. Emitters of the object that was edited last
  /// propagate first. While an object is selected, what its removal left to do below the threshold comes before its
  /// temporary place. so_far: of the same stretch, before the session was taken up; it counts.
  SessionWork work(const Budget& budget, SessionWork so_far = {});

  /// Adds all that was shot to an archive, under names that begin with `prefix`.
  void write(ArchiveWriter& file, const std::string& prefix) const;
  /// A session as it was written. scene, options: those that it began with; edits: all that it was told, in order. No
  /// shot is repeated; form factors are computed anew when they are asked for, those of patches that have gathered at
  /// once. It goes on to the same bits; with ObjectTerms::gathered but for the last ones, as columns that had been
  /// brought up to date by what was gathered are now made otherwise. Throws DamagedFile, and InvalidEdit where the
  /// edits were others.
  static EditSession taken_up(Scene scene, const SessionOptions& options, std::span<const Edit> edits,
                              const ArchiveReader& file, const std::string& prefix);

  /// The separate buffer of a selected object: by element and band, what it adds to the solution without it. Empty when
  /// none is shown.
  std::vector<double> temporary_change() const;

  /// Changes that are not worked off, the oldest first: what was interrupted stays here until time is found for it.
  std::vector<PendingChange> log();
  /// [W or lm] largest energy left to redistribute, as ranked; to propagate.
  double redistribution_left();
  double propagation_left() const { return solution().strongest().energy; }

 private:
  void change_geometry(DynamicRadiosity& of, std::uint32_t object, const std::string& name);
  DynamicRadiosity& state() { return shown_ ? *shown_ : base_; }
  bool propagates(const DynamicRadiosity& of, double strongest) const;
  bool step(DynamicRadiosity& of, SessionWork& work);
  std::optional<std::uint32_t> held() const;
  void open_temporary(std::uint32_t object);
  void set_options(const SessionOptions& options);
  std::string name_of_edit(const Edit& edit) const;

  SessionOptions options_;
  EditedScene scene_;
  DynamicRadiosity base_;                  ///< without the selected object, if there is one
  std::optional<DynamicRadiosity> shown_;  ///< with it
  std::optional<std::uint32_t> edited_;    ///< the object whose emitters come first
  /// While a session is taken up: all versions that its edits have made. What it shot is of some of them.
  std::optional<std::vector<std::shared_ptr<const SceneVersion>>> versions_;
};

}  // namespace exitance
