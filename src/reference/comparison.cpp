#include "src/reference/comparison.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "src/form_factor/area_cell.h"
#include "src/reference/patch_polynomials.h"
#include "src/scene/input_error.h"

namespace exitance {
namespace {

/// Exact for products of two polynomials of the highest degree.
constexpr int kOrder = 4;
/// Of all area, what two meshes of one scene may differ in: corners are merged in some files.
constexpr double kAreaTolerance = 1e-6;

/// One value at every point of a mesh.
class Function {
 public:
  Function(const PatchMesh& mesh, std::span<const double> means, std::uint32_t degree)
      : mesh_(mesh), polynomials_(mesh, degree), coefficients_(polynomials_.fit(means, 1)) {
    for (std::uint32_t e = 0; e < means.size(); ++e)
      shift_.push_back(means[e] - polynomials_.mean(e, coefficients_, 1, 0));
  }

  double at(std::uint32_t element, const Vec3& point) const {
    std::array<double, 10> term{};
    const std::uint32_t patch = mesh_.elements[element].patch;
    polynomials_.terms_at(patch, point, term);
    double value = shift_[element];
    for (std::size_t t = 0; t < polynomials_.terms(); ++t)
      value += term[t] * coefficients_[patch * polynomials_.terms() + t];
    return value;
  }

 private:
  const PatchMesh& mesh_;
  PatchPolynomials polynomials_;
  std::vector<double> coefficients_, shift_;
};

Vec3 doubled_area_vector(std::span<const Vec3> loop) {
  Vec3 sum;
  for (std::size_t k = 2; k < loop.size(); ++k) sum = sum + cross(loop[k - 1] - loop[0], loop[k] - loop[0]);
  return sum;
}

/// What one convex loop shares with another one in the same plane.
class Overlap {
 public:
  std::span<const Vec3> of(std::span<const Vec3> one, std::span<const Vec3> other) {
    loop_.assign(one.begin(), one.end());
    const Vec3 normal = doubled_area_vector(other);
    for (std::size_t k = 0; k < other.size() && loop_.size() > 2; ++k) {
      const Vec3 &a = other[k], inward = cross(normal, other[(k + 1) % other.size()] - a);
      clipped_.clear();
      for (std::size_t i = 0; i < loop_.size(); ++i) {
        const Vec3 &p = loop_[i], &q = loop_[(i + 1) % loop_.size()];
        const double at_p = dot(inward, p - a), at_q = dot(inward, q - a);
        if (at_p >= 0) clipped_.push_back(p);
        if ((at_p < 0) != (at_q < 0) && at_p != 0 && at_q != 0)
          clipped_.push_back(p + (at_p / (at_p - at_q)) * (q - p));
      }
      std::swap(loop_, clipped_);
    }
    if (loop_.size() < 3) loop_.clear();
    return loop_;
  }

 private:
  std::vector<Vec3> loop_, clipped_;
};

struct Bounds {
  Vec3 low, high;
  explicit Bounds(std::span<const Vec3> loop) : low(loop[0]), high(loop[0]) {
    for (const Vec3& v : loop) {
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], v[axis]);
        high[axis] = std::max(high[axis], v[axis]);
      }
    }
  }
};

/// The pieces of a mesh by surface, and there by their least x, y or z, whichever spreads most.
class PiecesOfSurfaces {
 public:
  struct Item {
    Bounds bounds;
    std::uint32_t element, piece;
  };

  explicit PiecesOfSurfaces(const PatchMesh& mesh) {
    for (std::uint32_t e = 0; e < mesh.elements.size(); ++e) {
      const Element& element = mesh.elements[e];
      for (std::uint32_t k = 0; k < element.piece_count; ++k) {
        const std::uint32_t piece = element.piece_first + k;
        of_[mesh.patches[element.patch].surface].items.push_back({Bounds(mesh.loop(mesh.pieces[piece])), e, piece});
      }
    }
    for (auto& [surface, pieces] : of_) pieces.sort();
  }

  template <class Visit>
  void for_each_near(std::uint32_t surface, const Bounds& box, const Visit& visit) const {
    const auto found = of_.find(surface);
    if (found == of_.end()) return;
    const Pieces& pieces = found->second;
    const int axis = pieces.axis;
    const auto low = [axis](const Item& item) { return item.bounds.low[axis]; };
    auto item = std::ranges::lower_bound(pieces.items, box.low[axis] - pieces.longest, {}, low);
    for (; item != pieces.items.end() && low(*item) <= box.high[axis]; ++item) {
      bool apart = false;
      for (int k = 0; k < 3; ++k)
        apart = apart || item->bounds.low[k] > box.high[k] || item->bounds.high[k] < box.low[k];
      if (!apart) visit(*item);
    }
  }

 private:
  struct Pieces {
    std::vector<Item> items;
    int axis = 0;
    double longest = 0;

    void sort() {
      Bounds all = items.front().bounds;
      for (const Item& item : items) {
        for (int k = 0; k < 3; ++k) {
          all.low[k] = std::min(all.low[k], item.bounds.low[k]);
          all.high[k] = std::max(all.high[k], item.bounds.high[k]);
        }
      }
      for (int k = 1; k < 3; ++k) {
        if (all.high[k] - all.low[k] > all.high[axis] - all.low[axis]) axis = k;
      }
      for (const Item& item : items) longest = std::max(longest, item.bounds.high[axis] - item.bounds.low[axis]);
      std::ranges::stable_sort(items, {}, [this](const Item& item) { return item.bounds.low[axis]; });
    }
  };
  std::map<std::uint32_t, Pieces> of_;
};

/// Of one element of the current solution, where the reference has something.
struct Shared {
  double area = 0, reference = 0, reference_squared = 0, difference_squared = 0;
};

Shared shared_by(const PatchMesh& mesh, std::uint32_t e, const Function& y, const PatchMesh& reference,
                 const PiecesOfSurfaces& pieces, const Function& y_reference) {
  Shared sum;
  Overlap overlap;
  std::vector<WeightedPoint> points;
  const Element& element = mesh.elements[e];
  for (const PatchPiece& piece : mesh.pieces_of(element)) {
    const auto loop = mesh.loop(piece);
    pieces.for_each_near(mesh.patches[element.patch].surface, Bounds(loop), [&](const PiecesOfSurfaces::Item& item) {
      for (const AreaCell& cell : cells_of(overlap.of(loop, reference.loop(reference.pieces[item.piece])))) {
        gauss_points(cell, kOrder, points);
        for (const WeightedPoint& x : points) {
          const double value = y_reference.at(item.element, x.point), apart = value - y.at(e, x.point);
          sum.area += x.weight;
          sum.reference += x.weight * value;
          sum.reference_squared += x.weight * value * value;
          sum.difference_squared += x.weight * apart * apart;
        }
      }
    });
  }
  return sum;
}

double relative(double squared_difference, double squared_reference) {
  if (squared_difference == 0) return 0;
  return squared_reference > 0 ? std::sqrt(squared_difference / squared_reference)
                               : std::numeric_limits<double>::infinity();
}

double worst_1_percent(const Comparison& c, std::span<const Shared> shared) {
  std::vector<std::size_t> order(shared.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(),
                           [&](std::size_t e) { return std::fabs(c.Y_reference[e] - c.Y_current[e]); });
  double left = 0, difference = 0, reference = 0;
  for (const Shared& s : shared) left += 0.01 * s.area;
  for (const std::size_t e : order) {
    const double area = std::min(left, shared[e].area), apart = c.Y_reference[e] - c.Y_current[e];
    difference += area * apart * apart;
    reference += area * c.Y_reference[e] * c.Y_reference[e];
    left -= area;
    if (left <= 0) break;
  }
  return relative(difference, reference);
}

std::vector<double> luminance_of(const SolutionRecord& record) {
  if (record.bands == 0 || record.B.size() != record.mesh.elements.size() * record.bands)
    throw InputError(record.source, 0, "does not have all bands of B for all elements; solve the scene again");
  return luminance(record.B, record.bands, record.mesh.elements.size());
}

void refuse_other_scenes(const SolutionRecord& reference, const SolutionRecord& current) {
  if (reference.scene_hash != current.scene_hash)
    throw InputError(current.source, 0,
                     fmt::format("is a solution of another scene ({}) than {} ({}); compare solutions of one scene",
                                 current.scene, reference.source, reference.scene));
  if (reference.bands != current.bands)
    throw InputError(current.source, 0,
                     fmt::format("has {} bands, {} has {}; compare solutions of one scene", current.bands,
                                 reference.source, reference.bands));
}

}  // namespace

Comparison compare(const SolutionRecord& reference, const SolutionRecord& current) {
  refuse_other_scenes(reference, current);
  const std::vector<double> Y_reference = luminance_of(reference);
  Comparison result;
  result.Y_current = luminance_of(current);
  const Function y_reference(reference.mesh, Y_reference, reference.degree);
  const Function y(current.mesh, result.Y_current, current.degree);
  const PiecesOfSurfaces pieces(reference.mesh);
  std::vector<Shared> shared(current.mesh.elements.size());
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(shared.size())),
                    [&](const auto& some) {
                      for (std::uint32_t e = some.begin(); e < some.end(); ++e)
                        shared[e] = shared_by(current.mesh, e, y, reference.mesh, pieces, y_reference);
                    });

  double difference = 0, of_means = 0, pointwise = 0, of_points = 0, area = 0, missed = 0;
  for (std::size_t e = 0; e < shared.size(); ++e) {
    const Shared& s = shared[e];
    result.Y_reference.push_back(s.area > 0 ? s.reference / s.area : result.Y_current[e]);
    const double apart = result.Y_reference[e] - result.Y_current[e];
    difference += s.area * apart * apart;
    of_means += s.area * result.Y_reference[e] * result.Y_reference[e];
    pointwise += s.difference_squared;
    of_points += s.reference_squared;
    area += current.mesh.elements[e].area;
    missed += std::fabs(current.mesh.elements[e].area - s.area);
  }
  double reference_area = 0;
  for (const Element& e : reference.mesh.elements) reference_area += e.area;
  if (missed > kAreaTolerance * area || std::fabs(reference_area - area) > kAreaTolerance * area)
    throw InputError(
        current.source, 0,
        fmt::format("does not cover the surfaces that {} does; compare solutions of one scene", reference.source));
  result.error = relative(difference, of_means);
  result.error_worst_1_percent = worst_1_percent(result, shared);
  result.pointwise_error = relative(pointwise, of_points);
  return result;
}

std::vector<double> squared_distances(const PatchMesh& mesh, std::span<const double> u, std::uint32_t degree_u,
                                      std::span<const double> v, std::uint32_t degree_v) {
  const Function f(mesh, u, degree_u), g(mesh, v, degree_v);
  std::vector<double> distances(mesh.patches.size());
  std::vector<WeightedPoint> points;
  for (std::uint32_t e = 0; e < mesh.elements.size(); ++e) {
    for (const PatchPiece& piece : mesh.pieces_of(mesh.elements[e])) {
      for (const AreaCell& cell : cells_of(mesh.loop(piece))) {
        gauss_points(cell, kOrder, points);
        for (const WeightedPoint& x : points) {
          const double apart = f.at(e, x.point) - g.at(e, x.point);
          distances[mesh.elements[e].patch] += x.weight * apart * apart;
        }
      }
    }
  }
  return distances;
}

}  // namespace exitance
