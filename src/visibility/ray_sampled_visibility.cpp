#include "src/visibility/ray_sampled_visibility.h"

#include <embree3/rtcore.h>
#include <immintrin.h>

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace exitance {
namespace {

/// Embree wants denormal numbers flushed to zero; exact predicates must not have them so. Held while rays are cast.
class DenormalsFlushed {
 public:
  DenormalsFlushed() : before_(_mm_getcsr()) { _mm_setcsr(before_ | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON); }
  ~DenormalsFlushed() { _mm_setcsr(before_); }
  DenormalsFlushed(const DenormalsFlushed&) = delete;
  DenormalsFlushed& operator=(const DenormalsFlushed&) = delete;

 private:
  unsigned before_;
};

/// Whitens a number (the output function of SplitMix64; Steele, Lea and Flood 2014).
std::uint64_t mixed(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// Bits 0 … 15 spread to the even places.
std::uint32_t spread(std::uint32_t bits) {
  bits = (bits | (bits << 8)) & 0x00ff00ffu;
  bits = (bits | (bits << 4)) & 0x0f0f0f0fu;
  bits = (bits | (bits << 2)) & 0x33333333u;
  return (bits | (bits << 1)) & 0x55555555u;
}

/// The first points of Sobol's sequence in two dimensions, in units of 2^-32, in Morton order, so that the rays of a
/// packet are neighbours. A digital shift keeps dyadic squares together, and so this order good.
std::vector<std::array<std::uint32_t, 2>> sobol_points(std::uint32_t count) {
  boost::random::sobol_engine<std::uint32_t, 32> sobol(2);
  std::vector<std::array<std::uint32_t, 2>> points(1);  // Boost leaves out the origin, which makes 2^k points a net
  while (points.size() < count) {
    const std::uint32_t u = sobol();
    points.push_back({u, sobol()});
  }
  const auto morton = [](const auto& p) { return spread(p[0] >> 16) << 1 | spread(p[1] >> 16); };
  std::ranges::stable_sort(points, {}, morton);
  return points;
}

using Loop = boost::container::small_vector<Vec3, 12>;

/// The part of a source above the horizon, relative to the point of view, clockwise or counter-clockwise.
Loop above_horizon(const Receiver& receiver, const PolygonSoup& soup, const Source& source) {
  Loop whole, part;
  if (source.loop.empty()) {
    for (const Corner& c : soup.corners(soup.facets()[source.facet])) {
      whole.push_back(soup.vertices()[c.vertex] - receiver.point);
    }
  } else {
    for (const Vec3& v : source.loop) whole.push_back(v - receiver.point);
  }
  for (std::size_t k = 0; k < whole.size(); ++k) {
    const Vec3 &p = whole[k], &q = whole[(k + 1) % whole.size()];
    const double hp = dot(receiver.normal, p), hq = dot(receiver.normal, q);
    if (hp >= 0) part.push_back(p);
    if ((hp > 0 && hq < 0) || (hp < 0 && hq > 0)) part.push_back((1 / (hp - hq)) * (hp * q - hq * p));
  }
  return part;
}

/// Lambert's form factor of a loop relative to the point of view, above the horizon (its sign: which way it runs).
double unoccluded(const Loop& loop, const Vec3& unit_normal) {
  double sum = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 &p = loop[k], &q = loop[(k + 1) % loop.size()];
    const Vec3 c = cross(p, q);
    const double s = norm(c);
    if (s > 0) sum += std::atan2(s, dot(p, q)) * dot(unit_normal, c) / s;
  }
  return sum / (2 * std::numbers::pi);
}

/// Maps the unit square to a convex loop, uniformly and without a jump: u turns around the first corner, √v goes away
/// from it.
class FanMap {
 public:
  explicit FanMap(const Loop& loop) : loop_(loop) {
    up_to_.push_back(0);
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
      up_to_.push_back(up_to_.back() + norm(cross(loop[k] - loop[0], loop[k + 1] - loop[0])));
    }
  }
  double twice_area() const { return up_to_.back(); }

  Vec3 operator()(const std::array<std::uint32_t, 2>& point, std::uint64_t shift) const {
    const double u = (static_cast<double>(point[0] ^ static_cast<std::uint32_t>(shift)) + 0.5) * 0x1p-32;
    const double v = (static_cast<double>(point[1] ^ static_cast<std::uint32_t>(shift >> 32)) + 0.5) * 0x1p-32;
    const double a = u * twice_area();
    std::size_t k = 1;
    while (k + 1 < up_to_.size() && a > up_to_[k]) ++k;
    const double t = (a - up_to_[k - 1]) / (up_to_[k] - up_to_[k - 1]);
    return loop_[0] + std::sqrt(v) * ((1 - t) * (loop_[k] - loop_[0]) + t * (loop_[k + 1] - loop_[0]));
  }

 private:
  const Loop& loop_;
  boost::container::small_vector<double, 12> up_to_;  // twice the area of the triangles before
};

}  // namespace

struct RaySampledVisibility::EmbreeScene {
  struct Release {
    void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
    void operator()(RTCScene s) const { rtcReleaseScene(s); }
    void operator()(RTCGeometry g) const { rtcReleaseGeometry(g); }
  };
  template <class Handle>
  using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

  EmbreeScene(const PolygonSoup& soup, const RayOptions& options) : device(rtcNewDevice(nullptr)) {
    check();
    Box box;
    for (const Vec3& v : soup.vertices()) box.extend(v);
    if (soup.vertices().empty()) box.extend(Vec3{});
    centre = 0.5 * (box.lower + box.upper);
    offset = options.offset * 0.5 * norm(box.upper - box.lower);

    scene.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(scene.get(), options.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
    add_triangles(soup);
    rtcCommitScene(scene.get());
    check();
  }

  void add_triangles(const PolygonSoup& soup) {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (const Facet& f : soup.facets()) {
      if (soup.role(f.polygon) == Role::unoccluding) continue;
      const auto loop = soup.corners(f);
      for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
        triangles.push_back({loop[0].vertex, loop[k].vertex, loop[k + 1].vertex});
      }
    }
    if (triangles.empty()) return;
    const Owned<RTCGeometry> geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), soup.vertices().size()));
    auto* index = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), triangles.size()));
    check();
    for (const Vec3& v : soup.vertices()) {
      for (int axis = 0; axis < 3; ++axis) *vertex++ = static_cast<float>(v[axis] - centre[axis]);
    }
    for (const auto& t : triangles) index = std::copy(t.begin(), t.end(), index);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometry(scene.get(), geometry.get());
  }

  void check() const {
    const RTCError error = rtcGetDeviceError(device.get());
    if (error != RTC_ERROR_NONE || !device) throw std::runtime_error("Embree: error " + std::to_string(error));
  }

  /// Casts to up to one packet's width of points.
  template <class Packet>
  void cast(const Vec3& from, std::span<const Vec3> to, std::uint8_t* visible) const {
    constexpr std::size_t kWidth = sizeof(Packet::tfar) / sizeof(float);
    alignas(64) std::array<int, kWidth> valid;
    alignas(64) Packet rays;
    const float x = static_cast<float>(from.x - centre.x), y = static_cast<float>(from.y - centre.y),
                z = static_cast<float>(from.z - centre.z);
    for (std::size_t k = 0; k < kWidth; ++k) {
      const Vec3& target = to[std::min(k, to.size() - 1)];
      valid[k] = k < to.size() ? -1 : 0;
      rays.org_x[k] = x;
      rays.org_y[k] = y;
      rays.org_z[k] = z;
      rays.dir_x[k] = static_cast<float>(target.x - centre.x) - x;
      rays.dir_y[k] = static_cast<float>(target.y - centre.y) - y;
      rays.dir_z[k] = static_cast<float>(target.z - centre.z) - z;
      rays.tnear[k] = 0;
      rays.tfar[k] = 1;
      rays.time[k] = 0;
      rays.mask[k] = ~0u;
      rays.id[k] = 0;
      rays.flags[k] = 0;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    if constexpr (kWidth == 16) {
      rtcOccluded16(valid.data(), scene.get(), &context, &rays);
    } else {
      rtcOccluded8(valid.data(), scene.get(), &context, &rays);
    }
    for (std::size_t k = 0; k < to.size(); ++k) visible[k] = rays.tfar[k] >= 0;
  }

  template <class Packet>
  void cast_all(const Vec3& from, std::span<const Vec3> to, std::span<std::uint8_t> visible) const {
    constexpr std::size_t kWidth = sizeof(Packet::tfar) / sizeof(float);
    const DenormalsFlushed flushed;
    for (std::size_t first = 0; first < to.size(); first += kWidth) {
      cast<Packet>(from, to.subspan(first, std::min(kWidth, to.size() - first)), visible.data() + first);
    }
  }

  Owned<RTCDevice> device;
  Owned<RTCScene> scene;
  Vec3 centre;
  double offset = 0;  ///< [m]
};

RaySampledVisibility::RaySampledVisibility(const PolygonSoup& soup, const RayOptions& options)
    : soup_(&soup), options_(options) {
  if (options.rays < 1) throw std::invalid_argument("rays must be at least 1");
  if (options.replicates < 1) throw std::invalid_argument("replicates must be at least 1");
  if (options.packet != 8 && options.packet != 16) {
    throw std::invalid_argument("packet must be 8 or 16, not " + std::to_string(options.packet));
  }
  if (!(options.offset >= 0)) throw std::invalid_argument("offset must be at least 0");
  points_ = sobol_points(options.rays);
  embree_ = std::make_unique<EmbreeScene>(soup, options);
}
RaySampledVisibility::~RaySampledVisibility() = default;
RaySampledVisibility::RaySampledVisibility(RaySampledVisibility&&) noexcept = default;
RaySampledVisibility& RaySampledVisibility::operator=(RaySampledVisibility&&) noexcept = default;

void RaySampledVisibility::cast(const Vec3& from, std::span<const Vec3> to, std::span<std::uint8_t> visible) const {
  if (options_.packet == 16) {
    embree_->cast_all<RTCRay16>(from, to, visible);
  } else {
    embree_->cast_all<RTCRay8>(from, to, visible);
  }
}

namespace {

/// Both ends of a question, moved off their surfaces.
struct Ends {
  Vec3 from;
  Vec3 to_origin;  ///< add a point of the loop to get a ray's target
};

Ends moved_ends(const Receiver& receiver, const Plane& plane, double offset) {
  const double side = dot(plane.normal, receiver.point - plane.origin) >= 0 ? 1 : -1;
  return {receiver.point + offset * normalized(receiver.normal),
          receiver.point + side * offset * normalized(plane.normal)};
}

}  // namespace

RaySampledVisibility::Rays RaySampledVisibility::shadow_rays(const Receiver& receiver, const Source& source,
                                                             std::uint64_t seed) const {
  const Loop loop = above_horizon(receiver, *soup_, source);
  const Ends ends = moved_ends(receiver, soup_->facets()[source.facet].plane, embree_->offset);
  Rays rays{ends.from, {}};
  if (loop.size() < 3) return rays;
  const FanMap on_source(loop);
  for (const auto& p : points_) rays.to.push_back(ends.to_origin + on_source(p, mixed(seed)));
  return rays;
}

SampledFormFactor RaySampledVisibility::form_factor(const Receiver& receiver, const Source& source,
                                                    std::uint64_t seed) const {
  const Loop loop = above_horizon(receiver, *soup_, source);
  if (loop.size() < 3) return {};
  const FanMap on_source(loop);
  const double F_unoccluded = std::fabs(unoccluded(loop, normalized(receiver.normal)));
  if (!(on_source.twice_area() > 0) || F_unoccluded == 0) return {};
  const Ends ends = moved_ends(receiver, soup_->facets()[source.facet].plane, embree_->offset);

  constexpr std::size_t kBatch = 64;
  std::array<Vec3, kBatch> to;
  std::array<double, kBatch> weight;
  std::array<std::uint8_t, kBatch> visible;
  double sum = 0, sum_of_squares = 0;
  for (std::uint32_t replicate = 0; replicate < options_.replicates; ++replicate) {
    const std::uint64_t shift = mixed(seed + replicate * 0xd1342543de82ef95u);
    double seen = 0, all = 0;
    for (std::size_t first = 0; first < points_.size(); first += kBatch) {
      const std::size_t count = std::min(kBatch, points_.size() - first);
      for (std::size_t k = 0; k < count; ++k) {
        const Vec3 w = on_source(points_[first + k], shift);
        const double r2 = dot(w, w);
        // The source's cosine is its plane's distance, the same for all, over r.
        weight[k] = std::fmax(dot(receiver.normal, w), 0.0) / (r2 * r2);
        to[k] = ends.to_origin + w;
      }
      cast(ends.from, {to.data(), count}, {visible.data(), count});
      for (std::size_t k = 0; k < count; ++k) {
        all += weight[k];
        seen += visible[k] * weight[k];
      }
    }
    const double fraction = all > 0 ? seen / all : 0;
    sum += fraction;
    sum_of_squares += fraction * fraction;
  }
  const double n = options_.replicates, mean = sum / n;
  const double variance =
      n > 1 ? std::fmax(sum_of_squares / n - mean * mean, 0.0) / (n - 1) : std::numeric_limits<double>::infinity();
  return {F_unoccluded * mean, F_unoccluded * std::sqrt(variance), F_unoccluded};
}

}  // namespace exitance
