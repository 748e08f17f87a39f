#include "tests/simulator/render/ground_mirror.h"

#include <algorithm>

namespace parkade::simulator {

void MirrorWorld(const Scene& scene, const SceneSurfaces& surfaces, const PacketPoses& poses,
                 const LaneFlags& is_surface, SurfacePoints& points) {
  constexpr float kLift = 0.01f, kLeast = 0.012f;  // [m]; smaller shares are not seen
  constexpr std::array<float, kSamplesPerPixel> kTilts = {-0.012f, 0.006f, 0.012f, -0.006f};
  alignas(64) RTCRayHit16 hits;
  alignas(64) int valid[kPacketSize];
  std::array<float, kPacketSize> share{};
  bool is_any = false;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const size_t index = static_cast<size_t>(lane), sample = index % kSamplesPerPixel;
    const SurfacePoint& point = points[index];
    if (is_surface[index] && point.is_ground) share[index] = GroundMirror(scene, point);
    valid[lane] = share[index] > kLeast ? -1 : 0;
    if (!valid[lane]) continue;
    is_any = true;
    const Eigen::Vector3f normal =
        (point.normal + Eigen::Vector3f(kTilts[sample], -kTilts[sample], 0)).normalized();
    const Eigen::Vector3f mirrored = point.ray - 2 * point.ray.dot(normal) * normal;
    SetRay(hits.ray, lane, point.position + kLift * point.flat_normal, mirrored, 150,
           poses.Of(lane).time);
    ClearHit(hits, lane);
  }
  if (!is_any) return;
  const LaneFlags is_mover = surfaces.Trace(valid, hits);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (!valid[lane]) continue;
    const size_t index = static_cast<size_t>(lane);
    Color seen = scene.sky.Radiance(DirectionOf(hits.ray, lane)).min(6.0f);
    if (hits.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID) {
      SurfacePoint point = surfaces.PointOfHit(hits, lane, is_mover[index]);
      point.distance += points[index].distance;
      point.sample_angle = 2 * points[index].sample_angle;
      seen = Shade(scene, point);
    }
    points[index].reflected = seen * share[index];
  }
}

}  // namespace parkade::simulator
