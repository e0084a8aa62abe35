#pragma once
// A radiosity solution in a scene that changes: what has been shot, under which version of the scene, and what is to be
// redistributed (George, Sillion and Greenberg, "Radiosity redistribution for dynamic environments", IEEE CG&A 1990).

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "src/dynamic/form_factor_column.h"
#include "src/dynamic/object_rows.h"
#include "src/dynamic/version_difference.h"
#include "src/output/archive.h"
#include "src/scene/edit.h"
#include "src/solve/compensated.h"
#include "src/solve/radiosity_system.h"

namespace exitance {

/// How patches are ranked for redistribution: by the energy that they have shot towards what changed.
struct ImportanceOptions {
  enum class Kind : std::uint8_t {
    total,     ///< by all energy that they have shot, wherever it went
    exact,     ///< by the form factors from all elements of the changed objects, as they were and as they are
    estimated  ///< by those of points in them, facing each patch (importance.h)
  };
  Kind kind = Kind::estimated;
  std::uint32_t points = 1;  ///< of estimated: points an object, ≥ 1
};

/// One shot, and what it took.
struct DynamicShot {
  enum class Kind : std::uint8_t { propagation, redistribution, gathering };
  Kind kind = Kind::propagation;
  std::uint32_t patch = 0;
  double power = 0;  ///< Σ A ρ |ΔF| |what was shot|, luminance [W or lm]: what it moved; of gathering: what it brought
  ChangeWork work;
};

/// What has been shot before a change and is still to be redistributed: an entry of the paper's log.
struct PendingChange {
  std::string name;           ///< what changed then
  std::size_t patches = 0;    ///< that have yet to redistribute what they shot before
  std::uint32_t patch = 0;    ///< the one with the most energy left to redistribute
  double largest_energy = 0;  ///< its, as it is ranked [W or lm]
};

/// The state of a solution. At any time, for every element i that is there,
///
///   B_i = E_i + ρ_i (H_i + G_i),   H_i = Σ_v Σ_j F_ij^v S_j^v
///
/// where S_j^v is what patch j has shot by the form factors of version v of the scene. A propagation shot of patch j
/// adds its unshot ΔB_j to S_j by the present version. An edit of the geometry makes a new version. A redistribution
/// shot of j moves S_j^v from an older version to the present one: H_i changes by (F_ij^now − F_ij^v) S_j^v, for the
/// elements for which the two differ. That is R_i of eq. 5 with B_j − ΔB_j for B_j, as what had not been shot when the
/// change came needs no redistribution; energy that is shot after it is not redistributed either. When all of S is of
/// the present version and nothing is unshot, B solves it as if it had been solved from scratch.
///
/// Old versions are the log of changes: whatever was interrupted is kept in them and can be worked off later. Several
/// changes in between become one: a patch is moved from the version that it shot in to the present one at once. When a
/// changed object has itself shot, its patches of the old version take that back as a whole (negative energy); its
/// elements begin anew. Where the paper's text shoots ρ_j F_ij^Δt B_j, eq. 5 needs ρ_i; where Figure 2 multiplies F^Δt,
/// which is negative in a shadow, by −1, it means its magnitude.
///
/// G_i is 0 but for elements of objects that were changed and have gathered. When they came there, the older S had been
/// shot without them, so that their R_i are all that they get of it: Σ_v Σ_j F_ij S_j^v, v of the versions before. It
/// can be shot to them by each patch (Figure 2), or gathered, one row of form factors an element (section "The
/// redistribution algorithm"): G_i is what has been gathered and not yet been shot, by the form factors of the version
/// in which it was. A redistribution shot then only turns it into H_i, by those of the present one. It lasts until the
/// object itself changes.
///
/// A propagation shot takes the patch's column of form factors as it was kept, brought to the present version by what
/// has changed of it since, or computes it.
///
/// Copies are independent and share versions. Any number of threads gives the same bits.
class DynamicRadiosity {
 public:
  /// Nothing has been shot. column_memory: bytes that form factors kept for later shots may take.
  DynamicRadiosity(std::shared_ptr<const SceneVersion> version, const Scene& scene,
                   std::uint64_t column_memory = kColumnMemory);
  static constexpr std::uint64_t kColumnMemory = std::uint64_t{2} << 30;

  const SceneVersion& version() const { return *layers_.back().version; }
  std::shared_ptr<const SceneVersion> shared_version() const { return layers_.back().version; }
  std::uint32_t bands() const { return bands_; }

  /// The geometry of an object is now that of a version made from the present one; scene: as it is now. Its elements
  /// begin anew.
  void change_geometry(std::shared_ptr<const SceneVersion> version, const Scene& scene, std::uint32_t object,
                       const std::string& name);
  /// Reflectances and emissions of an object are now those of the scene: a correction of the radiosity of its patches,
  /// which is propagated; nothing is redistributed.
  void change_materials(const Scene& scene, std::uint32_t object);
  /// Forgets all that was shot, and all form factors.
  void start_over();

  /// What was shot in older versions counts as shot in the present one, and what changed objects shot as gone with
  /// them: nothing is pending any more, and what was not redistributed stays wrong (the paper's solution without a
  /// log), until the solution starts over.
  void forget_changes();
  bool has_forgotten() const { return has_forgotten_; }  ///< anything that was pending

  /// Shoots all of a patch's unshot radiosity.
  DynamicShot propagate(std::uint32_t patch);
  /// Redistributes what a patch shot in an older version. REQUIRES: change < pending_changes().
  DynamicShot redistribute(std::size_t change, std::uint32_t patch, VersionDifference::Search search);

  /// How many patches of the object that was changed last can still gather what is to be redistributed to them.
  std::uint32_t patches_to_gather() const;
  /// The next of them does. REQUIRES: patches_to_gather() > 0.
  DynamicShot gather();

  /// The oldest first; all patches of a change have been moved when it is gone.
  std::size_t pending_changes() const { return layers_.size() - 1; }
  PendingChange pending(std::size_t change);

  /// Of a pending change, by patch: [m²] power that reaches what changed, of the unit exitance that the patch has shot;
  /// the patch's own area where it is to take back all. Computed when first asked for; when that is does not matter.
  void set_importance(const ImportanceOptions& options);
  /// What decides the order: the luminance of what a patch has shot times its importance [W or lm].
  double redistribution_energy(std::size_t change, std::uint32_t patch);
  bool has_shot(std::uint32_t patch) const;  ///< by the present version
  bool has_to_redistribute(std::size_t change, std::uint32_t patch) const;

  /// The patch with the most to propagate: area times |ΔB|, luminance [W or lm]; of equals the first.
  struct Strongest {
    std::uint32_t patch = 0;
    double energy = 0;
  };
  Strongest strongest() const;
  Strongest strongest_of(std::uint32_t object) const;
  /// The one with the most to redistribute, and the change. energy −1: none has anything.
  struct StrongestChange {
    std::size_t change = 0;
    std::uint32_t patch = 0;
    double energy = -1;
    double of_all = 0;  ///< the sum over all that are still there, of all changes
  };
  StrongestChange strongest_change();

  /// Bound of ‖B − B*‖∞ / max B for patches, of the worst band, when no change is pending and none was forgotten.
  double error_bound() const;

  /// B and ΔB by patch and band. 0 where a patch is not there.
  const std::vector<double>& patch_B() const { return B_; }
  const std::vector<double>& unshot() const { return unshot_; }
  /// B by element and band, 0 where an element is not there.
  std::vector<double> element_B() const;
  double power_of_sources() const;  ///< Σ A E, luminance

  /// Areas, reflectances and emissions of what is there; black where nothing is.
  Discretisation discretisation() const;

  /// Adds what has been shot and received to an archive, under names that begin with `prefix`; versions by their serial
  /// numbers, no materials and no form factors.
  void write(ArchiveWriter& file, const std::string& prefix) const;
  /// Goes on from there; form factors are computed anew when they are asked for. REQUIRES: version and materials are
  /// those of the state that was written; versions: all that it had, and others; of two with the same number the later
  /// one. Throws DamagedFile.
  void read(const ArchiveReader& file, const std::string& prefix,
            std::span<const std::shared_ptr<const SceneVersion>> versions);

 private:
  struct Layer {
    std::shared_ptr<const SceneVersion> version;
    std::string name;                                       ///< of the change that ended it
    SharedRows<CompensatedSum> shot;                        ///< by patch and band
    std::shared_ptr<const std::vector<double>> importance;  ///< by patch; of all but the present one
  };

  /// What the patches of an object have gathered since it changed last.
  struct Gathering {
    std::uint32_t object;
    std::shared_ptr<const SceneVersion> version;  ///< that it came with, which its rows are of
    ObjectRows rows;                              ///< of its elements
    std::uint32_t patches;                        ///< the first of its, which have gathered
    std::vector<CompensatedSum> G;                ///< by element of the object and band
  };

  void fit_arrays();
  bool is_present(const Gathering& gathering) const { return gathering.version == shared_version(); }
  const ObjectRows& present_rows() const;
  const VersionDifference& since(const std::shared_ptr<const SceneVersion>& version);
  std::shared_ptr<const FormFactorColumn> present_column(std::uint32_t patch, ChangeWork& work);
  void set_materials(const Scene& scene, std::uint32_t object);
  double received(std::uint32_t element, std::uint32_t band) const;
  void drop_gathered();
  void find_rows(Gathering& gathering) const;
  void refresh(std::uint32_t patch);
  void receive(std::uint32_t element, double F, const double* amount);
  void refresh_patches_of(const std::vector<std::uint32_t>& elements);
  void drop_empty_layers();
  void take_from_gathered(const Layer& layer, std::uint32_t patch, std::vector<std::uint32_t>& touched);
  std::vector<double> importance_of(const Layer& layer, const VersionDifference& difference) const;
  void rank(Layer& layer);
  double luminance_of(const double* values) const;
  bool is_zero(const Layer& layer, std::uint32_t patch) const;

  std::uint32_t bands_;
  std::vector<double> weights_;        // of bands
  std::vector<Layer> layers_;          // the present one last
  std::vector<CompensatedSum> H_;      // by element and band
  std::vector<Gathering> gatherings_;  // that of the object that was changed last at the end
  std::vector<double> rho_, E_;        // by patch and band
  std::vector<double> B_, unshot_;     // by patch and band
  bool has_forgotten_ = false;
  ImportanceOptions importance_;
  ColumnStore columns_;
  std::vector<std::shared_ptr<const VersionDifference>> differences_;  // to the present version, where asked for
};

}  // namespace exitance
