#include "tests/simulator/render/sunlight.h"

#include <algorithm>

namespace parkade::simulator {
namespace {

/// Places of the four samples on the sun's disc.
constexpr std::array<std::array<float, 2>, kSamplesPerPixel> kSunOffsets = {
    {{0.6f, 0.2f}, {-0.2f, 0.6f}, {-0.6f, -0.2f}, {0.2f, -0.6f}}};

}  // namespace

Sunlight::Sunlight(const Scene& scene, const SceneSurfaces& surfaces, const RayScene& own_car)
    : scene_(scene), surfaces_(surfaces), own_car_(own_car) {
  const Eigen::Vector3f sun = scene.sky.sun_direction(), u = sun.unitOrthogonal(), v = sun.cross(u);
  for (size_t i = 0; i < kSamplesPerPixel; ++i)
    to_sun_[i] =
        (sun + Sky::kSunRadius * (kSunOffsets[i][0] * u + kSunOffsets[i][1] * v)).normalized();
}

bool Sunlight::Shines(const Eigen::Vector3f& eye, float time) const {
  if (scene_.sky.sun_irradiance()[0] <= 0) return false;
  alignas(64) RTCRay16 rays;
  alignas(64) int valid[kPacketSize] = {-1};
  SetRay(rays, 0, eye, to_sun_[0], 400, time);
  surfaces_.Occlude(valid, rays);
  return rays.tfar[0] >= 0;
}

void Sunlight::FallOn(const PacketPoses& poses, const LaneFlags& is_surface,
                      SurfacePoints& points) const {
  constexpr float kLift = 0.004f;          // [m] off the surface, against its own shadow
  constexpr float kOwnShadowReach = 8.0f;  // [m] from the body's origin
  if (scene_.sky.sun_irradiance()[0] <= 0) return;
  alignas(64) RTCRay16 in_world, in_body;
  alignas(64) int valid[kPacketSize], valid_near[kPacketSize];
  bool is_any = false, is_any_near = false;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const size_t index = static_cast<size_t>(lane), sample = index % kSamplesPerPixel;
    SurfacePoint& point = points[index];
    valid[lane] = valid_near[lane] = 0;
    if (!is_surface[index] || point.flat_normal.dot(to_sun_[sample]) <= 0) continue;
    point.sun = std::max(0.0f, point.normal.dot(to_sun_[sample]));
    const Eigen::Vector3f origin = point.position + kLift * point.flat_normal;
    SetRay(in_world, lane, origin, to_sun_[sample], 400, poses.Of(lane).time);
    valid[lane] = -1;
    is_any = true;
    const FastPose& body_from_world = poses.Of(lane).body_from_world;
    const Eigen::Vector3f origin_in_body = body_from_world * origin;
    if (origin_in_body.squaredNorm() > kOwnShadowReach * kOwnShadowReach) continue;
    SetRay(in_body, lane, origin_in_body, body_from_world.rotation * to_sun_[sample], 20, 0);
    valid_near[lane] = -1;
    is_any_near = true;
  }
  if (is_any) surfaces_.Occlude(valid, in_world);
  if (is_any_near) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    EmptyOtherLanes(valid_near, in_body);
    rtcOccluded16(valid_near, own_car_.scene(), &context, &in_body);
  }
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const bool is_hidden =
        (valid[lane] && in_world.tfar[lane] < 0) || (valid_near[lane] && in_body.tfar[lane] < 0);
    if (is_hidden) points[static_cast<size_t>(lane)].sun = 0;
  }
}

}  // namespace parkade::simulator
