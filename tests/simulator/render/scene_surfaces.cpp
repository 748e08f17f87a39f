#include "tests/simulator/render/scene_surfaces.h"

#include <algorithm>

namespace parkade::simulator {
namespace {

constexpr unsigned kGround = 0;  // geometry ids of the world

}  // namespace

SceneSurfaces::SceneSurfaces(const Scene& scene)
    : scene_(scene), world_({&scene.ground, &scene.objects}), movers_(scene.movers) {
  BakeLight();
}

void SceneSurfaces::BakeLight() {
  constexpr float kNearReach = 3;  // [m] within which things keep bounced light from each other
  const Mesh* const meshes[] = {&scene_.ground, &scene_.objects};
  for (size_t i = 0; i < 2; ++i) {
    ambient_[i] =
        world_.VertexAmbient(*meshes[i], scene_.sky_reach, i + 1, scene_.IsIndoors() ? 2 : 1);
    light_[i] = world_.VertexLamps(*meshes[i], scene_.lamps);
    if (!scene_.IsIndoors()) continue;
    const std::vector<float> openness = world_.VertexAmbient(*meshes[i], kNearReach, i + 3);
    for (size_t vertex = 0; vertex < openness.size(); ++vertex)
      light_[i][vertex] += scene_.bounce * (0.25f + 0.75f * openness[vertex]);
  }
}

SurfacePoint SceneSurfaces::PointInWorld(const RTCRayHit16& hits, int lane) const {
  const bool is_ground = hits.hit.geomID[lane] == kGround;
  const Mesh& mesh = is_ground ? scene_.ground : scene_.objects;
  const std::vector<float>& sky = ambient_[is_ground ? 0 : 1];
  const std::vector<Color>& lit = light_[is_ground ? 0 : 1];
  const auto& [a, b, c] = mesh.triangles[hits.hit.primID[lane]];
  const float u = hits.hit.u[lane], v = hits.hit.v[lane], w = 1 - u - v;
  SurfacePoint point;
  point.flat_normal =
      Eigen::Vector3f(hits.hit.Ng_x[lane], hits.hit.Ng_y[lane], hits.hit.Ng_z[lane]).normalized();
  point.normal = (w * mesh.normals[a] + u * mesh.normals[b] + v * mesh.normals[c]).normalized();
  const float visible_sky = w * sky[a] + u * sky[b] + v * sky[c];
  point.ambient = scene_.IsIndoors() ? visible_sky : 0.12f + 0.88f * visible_sky;
  point.openness = scene_.IsIndoors() ? std::min(1.0f, 2 * visible_sky) : 1;
  point.light = w * lit[a] + u * lit[b] + v * lit[c];
  point.is_ground = is_ground;
  point.material = mesh.triangle_materials[hits.hit.primID[lane]];
  return point;
}

SurfacePoint SceneSurfaces::PointOnMover(const RTCRayHit16& hits, int lane) const {
  const MoverScene::Placed& placed = movers_.placed(hits.hit.instID[0][lane]);
  const auto& [a, b, c] = placed.mesh->triangles[hits.hit.primID[lane]];
  const float u = hits.hit.u[lane], v = hits.hit.v[lane], w = 1 - u - v;
  const auto& normals = placed.mesh->normals;
  const Eigen::Vector3f flat_normal(hits.hit.Ng_x[lane], hits.hit.Ng_y[lane], hits.hit.Ng_z[lane]);
  SurfacePoint point;
  point.flat_normal = placed.world_from_mover.rotation * flat_normal.normalized();
  point.normal =
      (placed.world_from_mover.rotation * (w * normals[a] + u * normals[b] + v * normals[c]))
          .normalized();
  point.ambient = scene_.IsIndoors() ? 0.02f : 0.65f + 0.25f * point.normal.z();
  point.openness = scene_.IsIndoors() ? 0.0f : 1.0f;
  point.material = placed.mesh->triangle_materials[hits.hit.primID[lane]];
  return point;
}

SurfacePoint SceneSurfaces::PointOfHit(const RTCRayHit16& hits, int lane, bool is_mover) const {
  SurfacePoint point = is_mover ? PointOnMover(hits, lane) : PointInWorld(hits, lane);
  point.ray = {hits.ray.dir_x[lane], hits.ray.dir_y[lane], hits.ray.dir_z[lane]};
  point.distance = hits.ray.tfar[lane];
  point.position =
      Eigen::Vector3f(hits.ray.org_x[lane], hits.ray.org_y[lane], hits.ray.org_z[lane]) +
      point.distance * point.ray;
  // A surface seen from its back is lit as one that faces the eye.
  if (point.ray.dot(point.flat_normal) > 0) point.flat_normal = -point.flat_normal;
  if (point.normal.dot(point.flat_normal) < 0) point.normal = -point.normal;
  if (is_mover) point.light = scene_.lamps.Irradiance(point.position, point.normal) + scene_.bounce;
  return point;
}

LaneFlags SceneSurfaces::Trace(const int* valid, RTCRayHit16& hits) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  EmptyOtherLanes(valid, hits.ray);
  rtcIntersect16(valid, world_.scene(), &context, &hits);
  LaneFlags is_mover{};
  if (movers_.empty()) return is_mover;
  rtcInitIntersectContext(&context);
  rtcIntersect16(valid, movers_.scene(), &context, &hits);
  for (size_t lane = 0; lane < kPacketSize; ++lane)
    is_mover[lane] = valid[lane] && hits.hit.instID[0][lane] != RTC_INVALID_GEOMETRY_ID;
  return is_mover;
}

void SceneSurfaces::Occlude(const int* valid, RTCRay16& rays) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  EmptyOtherLanes(valid, rays);
  rtcOccluded16(valid, world_.scene(), &context, &rays);
  if (!movers_.empty()) rtcOccluded16(valid, movers_.scene(), &context, &rays);
}

}  // namespace parkade::simulator
