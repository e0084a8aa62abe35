#pragma once
// What benchmarks and experiments measure in: furnished rooms, points in them, and whole hemispheres seen from there.

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "geometry/viewpoint.h"
#include "src/scene/furnished_room.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/contacts.h"
#include "src/visibility/exact_visibility.h"
#include "src/visibility/shadow_rays.h"

namespace exitance {

/// Rays that one exact answer is compared with.
inline constexpr std::uint32_t kRays = 64;

/// A number below n, at the same fraction of n for the same random bits: of a scene cut finer, about the same place.
inline std::size_t below(std::mt19937_64& random, std::size_t n) {
  return static_cast<std::size_t>(static_cast<double>(random() >> 11) * 0x1p-53 * static_cast<double>(n));
}

struct MeasuredRoom {
  explicit MeasuredRoom(Scene s)
      : scene(std::move(s)), soup(make_soup(scene)), mesh(make_patch_mesh(scene, soup, {})), contacts(soup) {}

  std::uint32_t facets() const { return static_cast<std::uint32_t>(soup.facets().size()); }

  Scene scene;
  PolygonSoup soup;
  PatchMesh mesh;
  Contacts contacts;
};

/// A furnished room of so many polygons, always the same.
inline Scene furnished_room(std::int64_t polygons) {
  return make_furnished_room(static_cast<std::uint32_t>(polygons), 1);
}

/// The same scene with every facet cut into triangles, each a polygon of its own.
inline Scene cut_into_triangles(Scene scene) {
  const PolygonSoup soup = make_soup(scene);
  const std::vector<Surface> surfaces = std::exchange(scene.surfaces, {});
  for (const Facet& f : soup.facets()) {
    const auto loop = soup.corners(f);
    const auto corner = [&](std::size_t k) { return soup.vertices()[loop[k].vertex]; };
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
      Surface triangle = surfaces[f.polygon];
      triangle.polygon = {{corner(0), corner(k), corner(k + 1)}, {}};
      scene.surfaces.push_back(std::move(triangle));
    }
  }
  return scene;
}

inline Receiver receiver_at(const Element& e) {
  return {e.sample, e.normal, e.facet};
}

/// A sample point, each element's as likely as another's, that no contact buries.
inline const Element& random_element(const MeasuredRoom& room, std::mt19937_64& random) {
  for (;;) {
    const Element& e = room.mesh.elements[below(random, room.mesh.elements.size())];
    if (!room.contacts.covered(e.facet, e.sample)) return e;
  }
}

/// What a whole hemisphere holds.
struct Hemisphere {
  double sum = 0;           ///< of all form factors, front and back: 1 in a closed room
  std::size_t visible = 0;  ///< facets of which something is seen
};

/// Asks for every facet from one point.
inline Hemisphere look_around(const MeasuredRoom& room, Viewpoint& view, const Receiver& receiver) {
  view.look_from(receiver);
  Hemisphere all;
  for (std::uint32_t f = 0; f < room.facets(); ++f) {
    const PointFormFactor answer = view.form_factor({f, {}}, kPointTolerance);
    all.sum += answer.F;
    all.visible += answer.F > 0;
  }
  return all;
}

/// Throws when a hemisphere of a closed room is not whole: wrong answers are not worth measuring.
inline void require_closure(const Hemisphere& all, const Receiver& receiver) {
  if (std::fabs(all.sum - 1) < 1e-12) return;
  const Vec3 x = receiver.point;
  throw std::runtime_error(
      fmt::format("the form factors from point ({:.17g}, {:.17g}, {:.17g}) on facet {} sum to 1{:+.2g}", x.x, x.y, x.z,
                  receiver.facet, all.sum - 1));
}

/// This thread's processor time [s] that something takes: what else runs on the machine counts little.
template <class Work>
double seconds(const Work& work) {
  const auto now = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  const double start = now();
  work();
  return now() - start;
}

inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace exitance
