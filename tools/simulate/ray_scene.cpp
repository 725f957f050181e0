#include "simulate/ray_scene.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <thread>

namespace isthmus::sim {

struct RayScene::State {
  Mesh mesh;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~State() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

RayScene::RayScene(std::unique_ptr<State> state) : state_(std::move(state)) {}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
const Mesh& RayScene::mesh() const { return state_->mesh; }

Result<RayScene> RayScene::build(Mesh mesh) {
  auto state = std::make_unique<State>();
  state->mesh = std::move(mesh);
  state->device = rtcNewDevice(nullptr);
  if (state->device == nullptr)
    return fail("Embree does not start", "ray casting", "check the processor's SSE2 support");
  state->scene = rtcNewScene(state->device);
  rtcSetSceneFlags(state->scene, RTC_SCENE_FLAG_ROBUST);
  const Mesh& m = state->mesh;
  if (!m.triangles.empty()) {
    // Embree reads 16 bytes at the last vertex: one spare keeps that inside our buffer.
    state->mesh.vertices.emplace_back(Eigen::Vector3f::Zero());
    RTCGeometry geometry = rtcNewGeometry(state->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, m.vertices.data(), 0,
                               sizeof(Eigen::Vector3f), m.vertices.size() - 1);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, m.triangles.data(), 0,
                               sizeof(m.triangles[0]), m.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(state->scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  // Embree keeps on the stack what its tasks wait for, and its own TBB code is unseen by ThreadSanitizer: on a thread
  // of its own that stack is not ours again when the last of them still looks at it.
  RTCError error = rtcGetDeviceError(state->device);  // of this thread so far
  std::thread([&] {
    tbb::task_arena one_thread(1);
    one_thread.execute([&] { rtcJoinCommitScene(state->scene); });
    if (error == RTC_ERROR_NONE) error = rtcGetDeviceError(state->device);
  }).join();
  if (error != RTC_ERROR_NONE) {
    return fail(fmt::format("Embree error {} while building a scene of {} triangles", static_cast<int>(error),
                            m.triangles.size()),
                "ray casting", "fewer stations or more memory");
  }
  return RayScene(std::move(state));
}

void RayScene::trace(const Vector3d& origin, const Packet& packet, float far_m,
                     std::array<RawHit, kPacket>& hits) const {
  alignas(32) std::array<int, kPacket> valid{};
  RTCRayHit8 rays{};
  for (int k = 0; k < kPacket; ++k) {
    valid[k] = k < packet.count ? -1 : 0;
    rays.ray.org_x[k] = static_cast<float>(origin.x());
    rays.ray.org_y[k] = static_cast<float>(origin.y());
    rays.ray.org_z[k] = static_cast<float>(origin.z());
    rays.ray.dir_x[k] = packet.x[k];
    rays.ray.dir_y[k] = packet.y[k];
    rays.ray.dir_z[k] = packet.z[k];
    rays.ray.tfar[k] = far_m;
    rays.ray.mask[k] = 0xFFFFFFFFU;
    rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid.data(), state_->scene, &context, &rays);
  for (int k = 0; k < packet.count; ++k) {
    const bool hit = rays.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
    hits[k] = hit ? RawHit{rays.hit.primID[k], rays.ray.tfar[k]} : RawHit{};
  }
}

std::optional<Hit> RayScene::trace(const Vector3d& origin, const Vector3d& direction, double near_m,
                                   double far_m) const {
  RTCRayHit ray{};
  ray.ray.org_x = static_cast<float>(origin.x());
  ray.ray.org_y = static_cast<float>(origin.y());
  ray.ray.org_z = static_cast<float>(origin.z());
  ray.ray.dir_x = static_cast<float>(direction.x());
  ray.ray.dir_y = static_cast<float>(direction.y());
  ray.ray.dir_z = static_cast<float>(direction.z());
  ray.ray.tnear = static_cast<float>(near_m);
  ray.ray.tfar = static_cast<float>(far_m);
  ray.ray.mask = 0xFFFFFFFFU;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(state_->scene, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return resolve(origin, direction, RawHit{ray.hit.primID, ray.ray.tfar});
}

Hit RayScene::resolve(const Vector3d& origin, const Vector3d& direction, const RawHit& raw) const {
  const Mesh& m = state_->mesh;
  const auto& corner = m.triangles[raw.triangle];
  const Vector3d a = m.vertices[corner[0]].cast<double>();
  const Vector3d normal =
      (m.vertices[corner[1]].cast<double>() - a).cross(m.vertices[corner[2]].cast<double>() - a).normalized();
  Hit hit;
  hit.normal = normal;
  hit.material = m.materials[raw.triangle];
  const double along = normal.dot(direction);
  const double exact = normal.dot(a - origin) / along;
  // A ray in the plane of the triangle has no better range than the one Embree found.
  constexpr double kAgreement_m = 0.01;
  hit.range_m = std::abs(exact - raw.range_m) < kAgreement_m ? exact : static_cast<double>(raw.range_m);
  return hit;
}

}  // namespace isthmus::sim
