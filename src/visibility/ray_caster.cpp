#include "src/visibility/ray_caster.h"

#include <embree3/rtcore.h>
#include <immintrin.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace exitance {
namespace {

/// While it lives, this thread flushes denormal numbers to zero.
class DenormalsFlushed {
 public:
  DenormalsFlushed() : before_(_mm_getcsr()) { _mm_setcsr(before_ | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON); }
  ~DenormalsFlushed() { _mm_setcsr(before_); }
  DenormalsFlushed(const DenormalsFlushed&) = delete;
  DenormalsFlushed& operator=(const DenormalsFlushed&) = delete;

 private:
  unsigned before_;
};

struct Release {
  void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
  void operator()(RTCScene s) const { rtcReleaseScene(s); }
  void operator()(RTCGeometry g) const { rtcReleaseGeometry(g); }
};
template <class Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

/// Embree's functions by the width of packets.
void occluded(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRay8* rays) {
  rtcOccluded8(valid, scene, context, rays);
}
void occluded(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRay16* rays) {
  rtcOccluded16(valid, scene, context, rays);
}
void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit8* rays) {
  rtcIntersect8(valid, scene, context, rays);
}
void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit16* rays) {
  rtcIntersect16(valid, scene, context, rays);
}

/// Lets rays pass what they meet from behind, of triangles that have a twin which they meet from before. The geometry's
/// data: whether each triangle has.
void pass_backs_of_twins(const RTCFilterFunctionNArguments* args) {
  const auto& has_twin = *static_cast<const std::vector<std::uint8_t>*>(args->geometryUserPtr);
  for (unsigned k = 0; k < args->N; ++k) {
    if (args->valid[k] != -1 || has_twin[RTCHitN_primID(args->hit, args->N, k)] == 0) continue;
    const float along = RTCHitN_Ng_x(args->hit, args->N, k) * RTCRayN_dir_x(args->ray, args->N, k) +
                        RTCHitN_Ng_y(args->hit, args->N, k) * RTCRayN_dir_y(args->ray, args->N, k) +
                        RTCHitN_Ng_z(args->hit, args->N, k) * RTCRayN_dir_z(args->ray, args->N, k);
    if (along > 0) args->valid[k] = 0;
  }
}

/// Whether the other facet is the same turned over.
bool are_twins(const PolygonSoup& soup, std::uint32_t facet, std::uint32_t other) {
  const auto a = soup.corners(soup.facets()[facet]), b = soup.corners(soup.facets()[other]);
  const std::size_t n = a.size();
  if (b.size() != n) return false;
  for (std::size_t first = 0; first < n; ++first) {
    std::size_t same = 0;
    while (same < n && a[same].at == b[(first + n - same) % n].at) ++same;
    if (same == n) return true;
  }
  return false;
}

/// Of each facet, whether it is one side of a sheet.
std::vector<std::uint8_t> sides_of_sheets(const PolygonSoup& soup) {
  std::vector<std::uint8_t> are(soup.facets().size());
  for (std::uint32_t f = 0; f < are.size(); ++f) {
    are[f] = std::ranges::any_of(soup.coplanar(f), [&](std::uint32_t other) { return are_twins(soup, f, other); });
  }
  return are;
}

}  // namespace

struct RayCaster::EmbreeScene {
  EmbreeScene(const PolygonSoup& soup, const RayOptions& options) : device(rtcNewDevice(nullptr)) {
    exitance::check(options);
    check();
    Box box;
    for (const Vec3& v : soup.vertices()) box.extend(v);
    if (soup.vertices().empty()) box.extend(Vec3{});
    centre = 0.5 * (box.lower + box.upper);
    offset = options.offset * 0.5 * norm(box.upper - box.lower);
    packet = options.packet;
    scene.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(scene.get(), options.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
  }

  void check() const {
    const RTCError error = rtcGetDeviceError(device.get());
    if (error != RTC_ERROR_NONE || !device) throw std::runtime_error("Embree: error " + std::to_string(error));
  }

  void add(std::span<const Vec3> loop, std::uint32_t patch, bool twin = false) {
    const auto first = static_cast<std::uint32_t>(corners.size() / 3);
    for (const Vec3& v : loop) {
      for (int axis = 0; axis < 3; ++axis) corners.push_back(static_cast<float>(v[axis] - centre[axis]));
    }
    for (std::uint32_t k = 1; k + 1 < loop.size(); ++k) {
      triangles.push_back({first, first + k, first + k + 1});
      patch_of.push_back(patch);
      has_twin.push_back(twin);
    }
  }

  void add_facet(const PolygonSoup& soup, const Facet& facet, std::uint32_t patch = kNone, bool twin = false) {
    std::vector<Vec3> loop;
    for (const Corner& c : soup.corners(facet)) loop.push_back(c.at);
    add(loop, patch, twin);
  }

  void commit() {
    if (!triangles.empty()) {
      const Owned<RTCGeometry> geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
      auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
          geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), corners.size() / 3));
      auto* index = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
          geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), triangles.size()));
      check();
      std::ranges::copy(corners, vertex);
      for (const auto& t : triangles) index = std::ranges::copy(t, index).out;
      if (std::ranges::find(has_twin, 1) != has_twin.end()) {
        rtcSetGeometryUserData(geometry.get(), &has_twin);
        rtcSetGeometryIntersectFilterFunction(geometry.get(), pass_backs_of_twins);
      }
      rtcCommitGeometry(geometry.get());
      rtcAttachGeometry(scene.get(), geometry.get());
    }
    corners = {};
    triangles = {};
    // Embree builds its hierarchy with TBB while it flushes denormal numbers, and TBB takes the mode in which a thread
    // first uses it for all later tasks of that thread. So TBB must be in use before.
    tbb::task_arena().execute([&] { rtcCommitScene(scene.get()); });
    check();
  }

  template <class Packet>
  void set_ray(Packet& rays, std::size_t k, const Vec3& from, const Vec3& towards, float tfar) const {
    rays.org_x[k] = static_cast<float>(from.x - centre.x);
    rays.org_y[k] = static_cast<float>(from.y - centre.y);
    rays.org_z[k] = static_cast<float>(from.z - centre.z);
    rays.dir_x[k] = static_cast<float>(towards.x);
    rays.dir_y[k] = static_cast<float>(towards.y);
    rays.dir_z[k] = static_cast<float>(towards.z);
    rays.tnear[k] = 0;
    rays.tfar[k] = tfar;
    rays.time[k] = 0;
    rays.mask[k] = ~0u;
    rays.id[k] = 0;
    rays.flags[k] = 0;
  }

  template <class Packet>
  void cast(std::span<const Vec3> from, std::span<const Vec3> to, std::span<std::uint8_t> visible) const {
    constexpr std::size_t kWidth = sizeof(Packet::tfar) / sizeof(float);
    const DenormalsFlushed flushed;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = from.size() == 1 ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    alignas(64) std::array<int, kWidth> valid;
    alignas(64) Packet rays;
    for (std::size_t first = 0; first < to.size(); first += kWidth) {
      for (std::size_t k = 0; k < kWidth; ++k) {
        const std::size_t ray = std::min(first + k, to.size() - 1);
        valid[k] = first + k < to.size() ? -1 : 0;
        const Vec3& start = from[from.size() == 1 ? 0 : ray];
        set_ray(rays, k, start, to[ray] - start, 1);
        // The end is rounded as the corners of triangles are, then the difference.
        rays.dir_x[k] = static_cast<float>(to[ray].x - centre.x) - rays.org_x[k];
        rays.dir_y[k] = static_cast<float>(to[ray].y - centre.y) - rays.org_y[k];
        rays.dir_z[k] = static_cast<float>(to[ray].z - centre.z) - rays.org_z[k];
      }
      occluded(valid.data(), scene.get(), &context, &rays);
      for (std::size_t k = 0; k < kWidth && first + k < to.size(); ++k) visible[first + k] = rays.tfar[k] >= 0;
    }
  }

  template <class Packet>
  void first_hits(std::span<const Vec3> from, std::span<const Vec3> direction, std::span<RayHit> hits) const {
    constexpr std::size_t kWidth = sizeof(Packet::ray.tfar) / sizeof(float);
    const DenormalsFlushed flushed;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    alignas(64) std::array<int, kWidth> valid;
    alignas(64) Packet rays;
    for (std::size_t first = 0; first < direction.size(); first += kWidth) {
      for (std::size_t k = 0; k < kWidth; ++k) {
        const std::size_t ray = std::min(first + k, direction.size() - 1);
        valid[k] = first + k < direction.size() ? -1 : 0;
        set_ray(rays.ray, k, from[ray], direction[ray], std::numeric_limits<float>::infinity());
        rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        rays.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      }
      intersect(valid.data(), scene.get(), &context, &rays);
      for (std::size_t k = 0; k < kWidth && first + k < direction.size(); ++k) {
        RayHit& hit = hits[first + k] = {};
        if (rays.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
        hit.patch = patch_of[rays.hit.primID[k]];
        const float towards = rays.hit.Ng_x[k] * rays.ray.dir_x[k] + rays.hit.Ng_y[k] * rays.ray.dir_y[k] +
                              rays.hit.Ng_z[k] * rays.ray.dir_z[k];
        hit.side = towards < 0 ? RayHit::Side::front : RayHit::Side::back;
      }
    }
  }

  Owned<RTCDevice> device;
  Owned<RTCScene> scene;
  Vec3 centre;
  double offset = 0;  ///< [m]
  std::uint32_t packet = 16;
  std::vector<std::uint32_t> patch_of;                  ///< of each triangle
  std::vector<std::uint8_t> has_twin;                   ///< likewise: whether it is part of one side of a sheet
  std::vector<float> corners;                           ///< until they are committed, like
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< these
};

RayCaster::RayCaster(const PolygonSoup& soup, const RayOptions& options)
    : embree_(std::make_unique<EmbreeScene>(soup, options)) {
  for (const Facet& f : soup.facets()) {
    if (soup.role(f.polygon) != Role::unoccluding) embree_->add_facet(soup, f);
  }
  embree_->commit();
}

RayCaster::RayCaster(const PatchMesh& mesh, const PolygonSoup& soup, const RayOptions& options)
    : embree_(std::make_unique<EmbreeScene>(soup, options)) {
  const std::vector<std::uint8_t> of_sheet = sides_of_sheets(soup);
  for (std::uint32_t p = 0; p < mesh.patches.size(); ++p) {
    for (const PatchPiece& piece : mesh.pieces_of(mesh.patches[p])) {
      const bool twin = of_sheet[piece.facet] != 0;
      if (piece.loop_count == 0) {
        embree_->add_facet(soup, soup.facets()[piece.facet], p, twin);
      } else {
        embree_->add(mesh.loop(piece), p, twin);
      }
    }
  }
  for (const Facet& f : soup.facets()) {
    const Role role = soup.role(f.polygon);
    if (role == Role::sheet || role == Role::solid_face) embree_->add_facet(soup, f);
  }
  embree_->commit();
}

RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

void RayCaster::cast(std::span<const Vec3> from, std::span<const Vec3> to, std::span<std::uint8_t> visible) const {
  if (embree_->packet == 16) {
    embree_->cast<RTCRay16>(from, to, visible);
  } else {
    embree_->cast<RTCRay8>(from, to, visible);
  }
}

void RayCaster::first_hits(std::span<const Vec3> from, std::span<const Vec3> direction, std::span<RayHit> hits) const {
  if (embree_->packet == 16) {
    embree_->first_hits<RTCRayHit16>(from, direction, hits);
  } else {
    embree_->first_hits<RTCRayHit8>(from, direction, hits);
  }
}

double RayCaster::offset() const {
  return embree_->offset;
}

}  // namespace exitance
