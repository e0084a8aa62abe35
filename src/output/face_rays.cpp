#include "src/output/face_rays.h"

#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include <limits>
#include <stdexcept>

namespace exitance {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr float kCoincident = 1e-5f;  // relative distance within which faces count as one on top of the other

// A query; Embree hands it to the filters by its first member.
struct Query {
  RTCIntersectContext context;
  bool collect = false;  // remember the last of all faces instead of looking for the nearest
  RTCHit last{};
};

bool from_behind(const RTCRay& ray, const RTCHit& hit) {
  return ray.dir_x * hit.Ng_x + ray.dir_y * hit.Ng_y + ray.dir_z * hit.Ng_z >= 0;
}

void filter(const RTCFilterFunctionNArguments* arguments) {
  auto* query = reinterpret_cast<Query*>(arguments->context);
  const RTCRay ray = rtcGetRayFromRayN(arguments->ray, 1, 0);
  const RTCHit hit = rtcGetHitFromHitN(arguments->hit, 1, 0);
  if (from_behind(ray, hit)) {
    arguments->valid[0] = 0;
  } else if (query->collect) {
    if (query->last.primID == RTC_INVALID_GEOMETRY_ID || hit.primID > query->last.primID) query->last = hit;
    arguments->valid[0] = 0;
  }
}

}  // namespace

struct FaceRays::State {
  struct Primitive {
    std::uint32_t face;
    std::array<std::uint32_t, 4> corners;
    std::uint32_t corner_count;
  };
  std::vector<Primitive> primitives;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  RTCRayHit cast(const Vec3& direction, float from, float to, Query& query) const {
    RTCRayHit ray{};
    ray.ray.dir_x = static_cast<float>(direction.x);
    ray.ray.dir_y = static_cast<float>(direction.y);
    ray.ray.dir_z = static_cast<float>(direction.z);
    ray.ray.tnear = from;
    ray.ray.tfar = to;
    ray.ray.mask = ~0u;
    ray.hit.geomID = ray.hit.primID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcInitIntersectContext(&query.context);
    rtcIntersect1(scene, &query.context, &ray);
    return ray;
  }
};

FaceRays::FaceRays(const Faces& faces, const Vec3& origin) : state_(std::make_unique<State>()) {
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    const auto c = faces.corners(f);
    if (c.size() == 4) {
      state_->primitives.push_back({f, {c[0], c[1], c[2], c[3]}, 4});
    } else {
      for (std::size_t k = 2; k < c.size(); ++k) state_->primitives.push_back({f, {c[0], c[k - 1], c[k], c[k]}, 3});
    }
  }
  state_->device = rtcNewDevice(nullptr);
  if (!state_->device) throw std::runtime_error("Embree cannot be started");
  state_->scene = rtcNewScene(state_->device);
  rtcSetSceneFlags(state_->scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(state_->device, RTC_GEOMETRY_TYPE_QUAD);
  auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                             3 * sizeof(float), faces.points().size()));
  for (const Vec3& p : faces.points()) {
    const Vec3 relative = p - origin;
    for (int axis = 0; axis < 3; ++axis) *vertex++ = static_cast<float>(relative[axis]);
  }
  auto* index = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(std::uint32_t), state_->primitives.size()));
  // Embree's triangle (0, 1, 3) of a quadrilateral 0, 1, 2, 3 with 2 = 3 is ours; the other one is empty.
  for (const State::Primitive& primitive : state_->primitives) {
    for (const std::uint32_t corner : primitive.corners) *index++ = corner;
  }
  rtcSetGeometryIntersectFilterFunction(geometry, filter);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(state_->scene, geometry);
  rtcReleaseGeometry(geometry);
  // Embree builds with flush-to-zero on. Where that is a thread's first use of TBB, its arena would keep the mode and
  // hand it to every task ever after: an arena of our own, made before, and no other threads in it.
  tbb::task_arena(1).execute([&] { rtcCommitScene(state_->scene); });
  if (rtcGetDeviceError(state_->device) != RTC_ERROR_NONE) throw std::runtime_error("Embree cannot take the scene");
}

FaceRays::~FaceRays() = default;

std::optional<FaceHit> FaceRays::first_front(const Vec3& direction) const {
  Query query;
  const RTCRayHit nearest = state_->cast(direction, 0, kFar, query);
  if (nearest.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  query.collect = true;
  query.last.primID = RTC_INVALID_GEOMETRY_ID;
  const float t = nearest.ray.tfar;
  state_->cast(direction, t * (1 - kCoincident), t * (1 + kCoincident), query);
  const RTCHit& hit = query.last.primID == RTC_INVALID_GEOMETRY_ID ? nearest.hit : query.last;
  const State::Primitive& primitive = state_->primitives[hit.primID];
  return FaceHit{primitive.face, primitive.corners, primitive.corner_count, hit.u, hit.v};
}

}  // namespace exitance
