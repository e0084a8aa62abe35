#include "src/cli/link_settings.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "src/cli/number_range.h"

namespace exitance {

namespace {

/// From here on all pairs of them are too many.
constexpr std::size_t kManySurfaces = 1000;

}  // namespace

void LinkSettings::add_to(CLI::App& verb) {
  of_links_.push_back(verb.add_option("--eps", eps2_,
                                      "Of links: refined while B F, what they may bring to any point, is above this "
                                      "share of the brightest E; as the scene says unless given, or 0.005")
                          ->check(number_between(0)));
  of_links_.push_back(verb.add_option("--min-area", smallest_area_,
                                      "No sub-patch is smaller, about [m^2]; as the scene says unless given, or a "
                                      "6,000th of the area of all patches")
                          ->check(number_between(0)));
  of_links_.push_back(verb.add_option("--link-points", points_, "Points along the edge of a receiving sub-patch")
                          ->check(whole_number_between(1, 20))
                          ->capture_default_str());
}

void LinkSettings::add_clusters_to(CLI::App& verb) {
  clusters_ = "auto";
  of_links_.push_back(verb.add_option("--clusters", clusters_,
                                      "Link groups of patches, and patches only where B F of their groups may exceed "
                                      "--eps; auto: in scenes of more than 1,000 surfaces. These are cut then, unless "
                                      "--patch-size is given")
                          ->check(CLI::IsMember({"auto", "on", "off"}))
                          ->capture_default_str());
}

void LinkSettings::add_update_to(CLI::App& verb) {
  of_links_.push_back(
      verb.add_option("--eps1", eps1_, "Un-refined below this; half of --eps unless given")->check(number_between(0)));
  of_links_.push_back(verb.add_option("--b-eps", B_eps_,
                                      "Of hvt-peu: links that could not change by more than this share of the "
                                      "brightest E are left as they are; as the scene says unless given, or 0.0001")
                          ->check(number_between(0)));
}

LinkOptions LinkSettings::chosen(const DynamicScene& scene, std::optional<double> patch_size) const {
  LinkOptions options;
  const LinkDefaults& given = scene.links;
  options.mesh.patch_size = patch_size.value_or(given.patch_size.value_or(scene.scene.mesh.patch_size));
  options.eps2 = eps2_.value_or(given.eps2.value_or(options.eps2));
  options.eps1 = eps1_ ? *eps1_ : given.eps1 && !eps2_ ? std::min(*given.eps1, options.eps2) : options.eps2 / 2;
  options.B_eps = B_eps_.value_or(given.B_eps.value_or(options.B_eps));
  options.smallest_area = smallest_area_.value_or(given.smallest_area.value_or(options.smallest_area));
  options.points_per_edge = points_;
  options.clusters = clusters_ == "on" || (clusters_ == "auto" && scene.scene.surfaces.size() > kManySurfaces);
  const bool cut_as_said = patch_size || given.patch_size || scene.scene.mesh.patch_size > 0;
  if (options.clusters && !cut_as_said) {
    // What enters the shafts of a floor that is one patch would be much of a large scene.
    const double area = options.smallest_area > 0 ? options.smallest_area : default_smallest_area(scene.scene);
    options.mesh.patch_size = 2 * std::sqrt(area);
  }
  if (options.eps1 > options.eps2) throw CLI::ValidationError("--eps1", "must not be above --eps");
  return options;
}

void LinkSettings::refuse_any(const char* needed) const {
  const auto given = std::ranges::find_if(of_links_, [](const CLI::Option* o) { return o->count() > 0; });
  if (given != of_links_.end())
    throw CLI::ValidationError((*given)->get_name(), std::string("needs --method ") + needed);
}

}  // namespace exitance
