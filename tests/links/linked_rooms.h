#pragma once
// Solutions over links that tests make and compare.

#include <cstring>
#include <vector>

#include "src/links/linked_radiosity.h"
#include "tests/links/rooms.h"

namespace exitance {

inline Scene room_with_things() {
  Scene scene = empty_room();
  add(scene, "box on the floor", box_faces({0.5, 0.6, 0}, {1.2, 1.4, 0.8}, 2, 0));
  add(scene, "lamp", box_faces({1.8, 1.6, 1}, {2.1, 1.9, 1.2}, 3, 0));
  add(scene, "shelf", box_faces({2.2, 0.3, 0.9}, {2.9, 1.3, 1}, 2, 0));
  return scene;
}

inline LinkOptions coarse() {
  LinkOptions options;
  options.eps2 = 0.05;
  options.eps1 = 0.025;
  options.smallest_area = 0.02;
  options.tolerance = 1e-9;
  return options;
}

/// Eq. 7 against the converged solution on the same links.
inline double error_of(const LinkedRadiosity& links) {
  return link_error(links.tree(), links.elements(), 1, links.converged(), {}, links.radiosity().B()).all;
}

inline bool same_bits(const LinkIndex& a, const LinkIndex& b) {
  if (a.roots() != b.roots()) return false;
  for (std::uint32_t r = 0; r < a.roots(); ++r) {
    const auto x = a.of_receiver(r), y = b.of_receiver(r);
    if (x.size() != y.size()) return false;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Link &l = x[k], &m = y[k];
      if (l.code != m.code || l.source != m.source || l.destination != m.destination || l.next != m.next ||
          l.ghost != m.ghost || l.open != m.open || l.blocked != m.blocked || l.stale != m.stale ||
          std::memcmp(&l.form_factor, &m.form_factor, sizeof(double)) != 0 ||
          std::memcmp(&l.visibility, &m.visibility, sizeof(double)) != 0 ||
          std::memcmp(&l.energy, &m.energy, sizeof(double)) != 0) {
        return false;
      }
    }
  }
  return true;
}

inline bool same_bits(std::span<const double> a, std::span<const double> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace exitance
