#pragma once
// Where geometry is put: maps that keep degenerate configurations exact, and maps that round them.

#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/polygon.h"

namespace exitance {

/// FNV-1a, 64 bits.
inline std::uint64_t seed_of(std::string_view name) {
  std::uint64_t seed = 14695981039346656037u;
  for (const char c : name) seed = (seed ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return seed;
}

/// A sequence of numbers that is the same for the same name, on every machine.
class Random {
 public:
  explicit Random(std::string_view name) : bits_(seed_of(name)) {}
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  int whole(int low, int high) { return low + static_cast<int>(bits_() % static_cast<std::uint64_t>(high - low + 1)); }
  double real(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 bits_;
};

/// An affine map by its columns; scaling comes last, so that it can be a rounding of its own.
struct Placement {
  std::string name;
  Vec3 u{1, 0, 0}, v{0, 1, 0}, w{0, 0, 1}, origin;
  double scale = 1;

  Vec3 operator()(const Vec3& p) const { return scale * (origin + p.x * u + p.y * v + p.z * w); }
  Polygon operator()(Polygon polygon) const;
  /// A plane's normal goes with the cofactors. All maps here keep orientation.
  Vec3 normal(const Vec3& n) const { return n.x * cross(v, w) + n.y * cross(w, u) + n.z * cross(u, v); }
};

/// A rotation drawn at random, all of them equally likely; its columns are rounded.
Placement random_rotation(const std::string& name, const Vec3& origin, double scale, Random& random);

/// The lattice itself, in tenths, tilted (as exact, but no plane is an axis'), rotated by a rotation drawn from the
/// name (rounded), each also far from the origin, tiny and huge.
std::vector<Placement> placements(std::string_view name);

}  // namespace exitance
