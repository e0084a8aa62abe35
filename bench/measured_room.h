#pragma once
// What the benchmarks measure in: furnished rooms, points in them, and rays next to exact visibility.

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <vector>

#include "geometry/viewpoint.h"
#include "src/scene/furnished_room.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/ray_sampled_visibility.h"

namespace exitance {

/// A number below n from a seeded generator; n is small against 2^64.
inline std::size_t below(std::mt19937_64& random, std::size_t n) {
  return random() % n;
}

/// The same scene with every polygon as its facets' triangles.
inline Scene cut_into_triangles(const Scene& scene) {
  const PolygonSoup soup = make_soup(scene);
  Scene cut = scene;
  cut.surfaces.clear();
  for (const Facet& f : soup.facets()) {
    const auto loop = soup.corners(f);
    Surface surface = scene.surfaces[f.polygon];
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
      const auto v = [&](std::size_t i) { return soup.vertices()[loop[i].vertex]; };
      surface.polygon = {{v(0), v(k), v(k + 1)}, {}};
      if (area_vector(surface.polygon) != Vec3{}) cut.surfaces.push_back(surface);
    }
  }
  return cut;
}

struct MeasuredRoom {
  explicit MeasuredRoom(Scene s)
      : scene(std::move(s)), soup(make_soup(scene)), mesh(make_patch_mesh(scene, soup, {})) {}
  explicit MeasuredRoom(std::uint32_t polygons) : MeasuredRoom(make_furnished_room(polygons, 1)) {}

  std::uint32_t facets() const { return static_cast<std::uint32_t>(soup.facets().size()); }

  /// A sample point, uniform over the elements, that no contact covers.
  Receiver random_receiver(std::mt19937_64& random, Viewpoint& view) const {
    for (;;) {
      const Element& e = mesh.elements[below(random, mesh.elements.size())];
      const Receiver receiver{e.sample, e.normal, e.facet};
      view.look_from(receiver);
      if (!view.covered()) return receiver;
    }
  }

  Scene scene;
  PolygonSoup soup;
  PatchMesh mesh;
};

/// What a whole hemisphere holds.
struct Hemisphere {
  double sum = 0;           ///< of all form factors, front and back: 1 in a closed room
  std::size_t visible = 0;  ///< facets of which something is seen
};

/// Asks for every facet from the point the view is set to.
inline Hemisphere look_at_all(const MeasuredRoom& room, Viewpoint& view) {
  Hemisphere all;
  for (std::uint32_t f = 0; f < room.facets(); ++f) {
    const PointFormFactor answer = view.form_factor({f, {}}, 1e-12);
    all.sum += answer.F;
    all.visible += answer.F > 0;
  }
  return all;
}

/// A benchmark may not measure wrong answers. Points that see nothing are buried in a contact.
inline void require_closure(const Hemisphere& all, const Receiver& receiver) {
  if (all.visible > 0 && !(std::fabs(all.sum - 1) < 1e-12)) {
    throw std::runtime_error(fmt::format("closure missed by {:.3g} at point ({:.17g}, {:.17g}, {:.17g}) of facet {}",
                                         all.sum - 1, receiver.point.x, receiver.point.y, receiver.point.z,
                                         receiver.facet));
  }
}

/// Seconds of this thread's processor time that something takes: what else runs on the machine does not count.
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

/// Alternating measurements of several things, summed.
class Median {
 public:
  void add(double value) { values_.push_back(value); }
  double value() const {
    std::vector<double> sorted = values_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::ranges::nth_element(sorted, middle);
    return *middle;
  }

 private:
  std::vector<double> values_;
};

}  // namespace exitance
