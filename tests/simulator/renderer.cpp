#include "tests/simulator/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "tests/simulator/drivable_raster.h"
#include "tests/simulator/fast_pose.h"
#include "tests/simulator/headlights.h"
#include "tests/simulator/mover_scene.h"
#include "tests/simulator/ray_scene.h"
#include "tests/simulator/shading.h"

namespace parkade::simulator {
namespace {

constexpr unsigned kGround = 0;  // geometry ids of the world

/// Moments of the four samples within the exposure, in units of it; not in the
/// order of their places in the pixel, so that blur and edges do not conspire.
constexpr std::array<double, kSamplesPerPixel> kMoments = {-0.125, 0.375, -0.375, 0.125};

/// Places of the four samples on the sun's disc.
constexpr std::array<std::array<float, 2>, kSamplesPerPixel> kSunOffsets = {
    {{0.6f, 0.2f}, {-0.2f, 0.6f}, {-0.6f, -0.2f}, {0.2f, -0.6f}}};

void SetRay(RTCRay16& rays, int lane, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float far,
            float time) {
  rays.org_x[lane] = origin.x(), rays.org_y[lane] = origin.y(), rays.org_z[lane] = origin.z();
  rays.dir_x[lane] = direction.x(), rays.dir_y[lane] = direction.y(), rays.dir_z[lane] = direction.z();
  rays.tnear[lane] = 0, rays.tfar[lane] = far, rays.time[lane] = time;
  rays.mask[lane] = ~0u, rays.id[lane] = static_cast<unsigned>(lane), rays.flags[lane] = 0;
}

/// The car's place at the moment of each of the four samples of a row's pixels.
struct RowPoses {
  std::array<FastPose, kSamplesPerPixel> world_from_camera, world_from_body, body_from_world;
  std::array<float, kSamplesPerPixel> time{};  ///< of the samples, 0..1 over the picture
  float speed = 0;                             ///< [m/s]
  bool is_covered = false;                     ///< the car is under a roof
};

struct PacketResult {
  Color pixels[kPixelsPerPacket];
  int drivable[kPixelsPerPacket];  ///< samples on drivable ground
};

}  // namespace

struct Renderer::Parts {
  const Scene& scene;
  const Rig& rig;
  RayScene world, own_car;
  /// Of ground and objects, per vertex: the share of sky, and the light of lamps and walls.
  std::array<std::vector<float>, 2> ambient;
  std::array<std::vector<Color>, 2> light;
  std::vector<DrivableRaster> drivable;  ///< per sheet of the ground
  std::vector<SampleTable> tables;
  std::array<Eigen::Vector3f, kSamplesPerPixel> to_sun;
  mutable MoverScene movers;  ///< placed anew for each picture

  Parts(const Scene& scene_in, const Rig& rig_in, double half_field_of_view);
  void BakeLight();
  double RowOffset(const Shot& shot, int row) const;
  double PictureHalfTime(const Shot& shot) const;
  RowPoses PosesOfRow(const Shot& shot, int row) const;
  PacketResult RenderPacket(const Shot& shot, const RowPoses& poses, const SamplePacket& packet,
                            const float* sample_angles) const;
  SurfacePoint PointInWorld(const RTCRayHit16& hits, int lane) const;
  SurfacePoint PointOnMover(const RTCRayHit16& hits, int lane) const;
  SurfacePoint PointOfHit(const RTCRayHit16& hits, int lane, bool is_mover) const;
  std::array<bool, kPacketSize> Trace(const int* valid, RTCRayHit16& hits) const;
  void Mirror(const RowPoses& poses, const std::array<bool, kPacketSize>& is_surface,
              std::array<SurfacePoint, kPacketSize>& points) const;
  SurfacePoint PointOnOwnCar(const SampleTable& table, const RowPoses& poses, std::int32_t hit, int sample) const;
  void FindSun(const RowPoses& poses, const std::array<bool, kPacketSize>& is_surface,
               std::array<SurfacePoint, kPacketSize>& points) const;
  void LightNearOwnCar(const FastPose& body_from_world, SurfacePoint& point) const;
};

Renderer::Parts::Parts(const Scene& scene_in, const Rig& rig_in, double half_field_of_view)
    : scene(scene_in),
      rig(rig_in),
      world({&scene.ground, &scene.objects}),
      own_car({&scene.own_car}),
      movers(scene_in.movers) {
  for (size_t sheet = 0; sheet < scene.place.ground.sheets().size(); ++sheet) drivable.emplace_back(scene.place, sheet);
  BakeLight();
  for (const RigCamera& camera : rig.cameras)
    tables.push_back(MakeSampleTable(camera, scene.own_car, own_car, half_field_of_view));
  const Eigen::Vector3f sun = scene.sky.sun_direction(), u = sun.unitOrthogonal(), v = sun.cross(u);
  for (size_t i = 0; i < kSamplesPerPixel; ++i)
    to_sun[i] = (sun + Sky::kSunRadius * (kSunOffsets[i][0] * u + kSunOffsets[i][1] * v)).normalized();
}

void Renderer::Parts::BakeLight() {
  constexpr float kNearReach = 3;  // [m] within which things keep bounced light from each other
  const Mesh* const meshes[] = {&scene.ground, &scene.objects};
  for (size_t i = 0; i < 2; ++i) {
    ambient[i] = world.VertexAmbient(*meshes[i], scene.sky_reach, i + 1, scene.IsIndoors() ? 2 : 1);
    light[i] = world.VertexLamps(*meshes[i], scene.lamps);
    if (!scene.IsIndoors()) continue;
    const std::vector<float> openness = world.VertexAmbient(*meshes[i], kNearReach, i + 3);
    for (size_t vertex = 0; vertex < openness.size(); ++vertex)
      light[i][vertex] += scene.bounce * (0.25f + 0.75f * openness[vertex]);
  }
}

double Renderer::Parts::RowOffset(const Shot& shot, int row) const {
  const RigCamera& camera = rig.cameras[shot.camera];
  return camera.line_delay * (row - (camera.model.height() - 1) / 2.0);
}

double Renderer::Parts::PictureHalfTime(const Shot& shot) const {
  return RowOffset(shot, rig.cameras[shot.camera].model.height()) + shot.exposure / 2 + 1e-6;
}

RowPoses Renderer::Parts::PosesOfRow(const Shot& shot, int row) const {
  const RigCamera& camera = rig.cameras[shot.camera];
  const double row_offset = RowOffset(shot, row), half_picture = PictureHalfTime(shot);
  RowPoses poses;
  Eigen::Vector3d first = Eigen::Vector3d::Zero(), last = first;
  for (size_t sample = 0; sample < kSamplesPerPixel; ++sample) {
    const Rigid3 world_from_body = shot.world_from_body(row_offset + kMoments[sample] * shot.exposure);
    poses.world_from_body[sample] = FastPose(world_from_body);
    poses.body_from_world[sample] = FastPose(world_from_body.Inverse());
    poses.world_from_camera[sample] = FastPose(world_from_body * camera.body_from_camera);
    poses.time[sample] = static_cast<float>(
        std::clamp(0.5 + 0.5 * (row_offset + kMoments[sample] * shot.exposure) / half_picture, 0.0, 1.0));
    if (sample == 1) last = world_from_body.translation;
    if (sample == 2) first = world_from_body.translation;
  }
  if (shot.exposure > 0) poses.speed = static_cast<float>((last - first).norm() / (0.75 * shot.exposure));
  return poses;
}

SurfacePoint Renderer::Parts::PointInWorld(const RTCRayHit16& hits, int lane) const {
  const bool is_ground = hits.hit.geomID[lane] == kGround;
  const Mesh& mesh = is_ground ? scene.ground : scene.objects;
  const std::vector<float>& sky = ambient[is_ground ? 0 : 1];
  const std::vector<Color>& lit = light[is_ground ? 0 : 1];
  const auto& [a, b, c] = mesh.triangles[hits.hit.primID[lane]];
  const float u = hits.hit.u[lane], v = hits.hit.v[lane], w = 1 - u - v;
  SurfacePoint point;
  point.flat_normal = Eigen::Vector3f(hits.hit.Ng_x[lane], hits.hit.Ng_y[lane], hits.hit.Ng_z[lane]).normalized();
  point.normal = (w * mesh.normals[a] + u * mesh.normals[b] + v * mesh.normals[c]).normalized();
  const float visible_sky = w * sky[a] + u * sky[b] + v * sky[c];
  point.ambient = scene.IsIndoors() ? visible_sky : 0.12f + 0.88f * visible_sky;
  point.openness = scene.IsIndoors() ? std::min(1.0f, 2 * visible_sky) : 1;
  point.light = w * lit[a] + u * lit[b] + v * lit[c];
  point.is_ground = is_ground;
  point.material = mesh.triangle_materials[hits.hit.primID[lane]];
  return point;
}

SurfacePoint Renderer::Parts::PointOnOwnCar(const SampleTable& table, const RowPoses& poses, std::int32_t index,
                                            int sample) const {
  const OwnCarHit& hit = table.own_car_hits[static_cast<size_t>(index)];
  const size_t moment = static_cast<size_t>(sample);
  SurfacePoint point;
  point.position = poses.world_from_body[moment] * hit.point_in_body;
  point.normal = point.flat_normal = poses.world_from_body[moment].rotation * hit.normal_in_body;
  point.ray = (point.position - poses.world_from_camera[moment].translation).normalized();
  point.distance = hit.distance;
  point.ambient = poses.is_covered ? 0.03f : 0.8f;
  point.openness = poses.is_covered ? 0.0f : 1.0f;
  point.light = scene.lamps.Irradiance(point.position, point.normal) + (poses.is_covered ? scene.bounce : Gray(0));
  point.material = hit.material;
  return point;
}

SurfacePoint Renderer::Parts::PointOnMover(const RTCRayHit16& hits, int lane) const {
  const MoverScene::Placed& placed = movers.placed(hits.hit.instID[0][lane]);
  const auto& [a, b, c] = placed.mesh->triangles[hits.hit.primID[lane]];
  const float u = hits.hit.u[lane], v = hits.hit.v[lane], w = 1 - u - v;
  const auto& normals = placed.mesh->normals;
  const Eigen::Vector3f flat_normal(hits.hit.Ng_x[lane], hits.hit.Ng_y[lane], hits.hit.Ng_z[lane]);
  SurfacePoint point;
  point.flat_normal = placed.world_from_mover.rotation * flat_normal.normalized();
  point.normal = (placed.world_from_mover.rotation * (w * normals[a] + u * normals[b] + v * normals[c])).normalized();
  point.ambient = scene.IsIndoors() ? 0.02f : 0.65f + 0.25f * point.normal.z();
  point.openness = scene.IsIndoors() ? 0.0f : 1.0f;
  point.material = placed.mesh->triangle_materials[hits.hit.primID[lane]];
  return point;
}

SurfacePoint Renderer::Parts::PointOfHit(const RTCRayHit16& hits, int lane, bool is_mover) const {
  SurfacePoint point = is_mover ? PointOnMover(hits, lane) : PointInWorld(hits, lane);
  point.ray = {hits.ray.dir_x[lane], hits.ray.dir_y[lane], hits.ray.dir_z[lane]};
  point.distance = hits.ray.tfar[lane];
  point.position =
      Eigen::Vector3f(hits.ray.org_x[lane], hits.ray.org_y[lane], hits.ray.org_z[lane]) + point.distance * point.ray;
  // A surface seen from its back is lit as one that faces the eye.
  if (point.ray.dot(point.flat_normal) > 0) point.flat_normal = -point.flat_normal;
  if (point.normal.dot(point.flat_normal) < 0) point.normal = -point.normal;
  if (is_mover) point.light = scene.lamps.Irradiance(point.position, point.normal) + scene.bounce;
  return point;
}

/// Shoots rays at the world and the movers; tells which lanes hit a mover.
std::array<bool, kPacketSize> Renderer::Parts::Trace(const int* valid, RTCRayHit16& hits) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, world.scene(), &context, &hits);
  std::array<bool, kPacketSize> is_mover{};
  if (movers.empty()) return is_mover;
  rtcInitIntersectContext(&context);
  rtcIntersect16(valid, movers.scene(), &context, &hits);
  for (size_t lane = 0; lane < kPacketSize; ++lane)
    is_mover[lane] = valid[lane] && hits.hit.instID[0][lane] != RTC_INVALID_GEOMETRY_ID;
  return is_mover;
}

/// What a wet or sealed ground mirrors of the world. The samples of a pixel look along slightly
/// unlike directions, as water is not quite even.
void Renderer::Parts::Mirror(const RowPoses& poses, const std::array<bool, kPacketSize>& is_surface,
                             std::array<SurfacePoint, kPacketSize>& points) const {
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
    const Eigen::Vector3f normal = (point.normal + Eigen::Vector3f(kTilts[sample], -kTilts[sample], 0)).normalized();
    const Eigen::Vector3f mirrored = point.ray - 2 * point.ray.dot(normal) * normal;
    SetRay(hits.ray, lane, point.position + kLift * point.flat_normal, mirrored, 150, poses.time[sample]);
    hits.hit.geomID[lane] = hits.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
  if (!is_any) return;
  const std::array<bool, kPacketSize> is_mover = Trace(valid, hits);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (!valid[lane]) continue;
    const size_t index = static_cast<size_t>(lane);
    Color seen = scene.sky.Radiance({hits.ray.dir_x[lane], hits.ray.dir_y[lane], hits.ray.dir_z[lane]}).min(6.0f);
    if (hits.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID) {
      SurfacePoint point = PointOfHit(hits, lane, is_mover[index]);
      point.distance += points[index].distance;
      point.sample_angle = 2 * points[index].sample_angle;
      seen = Shade(scene, point);
    }
    points[index].reflected = seen * share[index];
  }
}

void Renderer::Parts::FindSun(const RowPoses& poses, const std::array<bool, kPacketSize>& is_surface,
                              std::array<SurfacePoint, kPacketSize>& points) const {
  constexpr float kLift = 0.004f;          // [m] off the surface, against its own shadow
  constexpr float kOwnShadowReach = 8.0f;  // [m] from the body's origin
  if (scene.sky.sun_irradiance()[0] <= 0) return;
  alignas(64) RTCRay16 in_world, in_body;
  alignas(64) int valid[kPacketSize], valid_near[kPacketSize];
  bool is_any = false, is_any_near = false;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const size_t index = static_cast<size_t>(lane), sample = index % kSamplesPerPixel;
    SurfacePoint& point = points[index];
    valid[lane] = valid_near[lane] = 0;
    if (!is_surface[index] || point.flat_normal.dot(to_sun[sample]) <= 0) continue;
    point.sun = std::max(0.0f, point.normal.dot(to_sun[sample]));
    const Eigen::Vector3f origin = point.position + kLift * point.flat_normal;
    SetRay(in_world, lane, origin, to_sun[sample], 400, poses.time[sample]);
    valid[lane] = -1;
    is_any = true;
    const FastPose& body_from_world = poses.body_from_world[sample];
    const Eigen::Vector3f origin_in_body = body_from_world * origin;
    if (origin_in_body.squaredNorm() > kOwnShadowReach * kOwnShadowReach) continue;
    SetRay(in_body, lane, origin_in_body, body_from_world.rotation * to_sun[sample], 20, 0);
    valid_near[lane] = -1;
    is_any_near = true;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  if (is_any) rtcOccluded16(valid, world.scene(), &context, &in_world);
  if (is_any && !movers.empty()) rtcOccluded16(valid, movers.scene(), &context, &in_world);
  if (is_any_near) rtcOccluded16(valid_near, own_car.scene(), &context, &in_body);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const bool is_hidden = (valid[lane] && in_world.tfar[lane] < 0) || (valid_near[lane] && in_body.tfar[lane] < 0);
    if (is_hidden) points[static_cast<size_t>(lane)].sun = 0;
  }
}

/// The car hides light from the ground beside and below it, and its headlights shine ahead.
void Renderer::Parts::LightNearOwnCar(const FastPose& body_from_world, SurfacePoint& point) const {
  const Eigen::Vector3f in_body = body_from_world * point.position;
  const float beyond_x = std::max({-0.7f - in_body.x(), in_body.x() - 3.2f, 0.0f});
  const float beyond_y = std::max(std::abs(in_body.y()) - 0.85f, 0.0f);
  const float away = std::hypot(beyond_x, beyond_y) + std::max(0.0f, in_body.z());
  if (away < 3) {
    const float left = 1 - 0.7f * std::exp(-away / 0.4f);
    point.ambient *= left;
    point.light *= left;
  }
  if (scene.has_headlights) point.light += HeadlightIrradiance(in_body, body_from_world.rotation * point.normal);
}

PacketResult Renderer::Parts::RenderPacket(const Shot& shot, const RowPoses& poses, const SamplePacket& packet,
                                           const float* sample_angles) const {
  alignas(64) RTCRayHit16 hits;
  alignas(64) int valid[kPacketSize];
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const FastPose& world_from_camera = poses.world_from_camera[static_cast<size_t>(lane % kSamplesPerPixel)];
    valid[lane] = packet.target[lane] == kWorld ? -1 : 0;
    const Eigen::Vector3f direction(packet.x[lane], packet.y[lane], packet.z[lane]);
    SetRay(hits.ray, lane, world_from_camera.translation, world_from_camera.rotation * direction, 1000,
           poses.time[static_cast<size_t>(lane % kSamplesPerPixel)]);
    hits.hit.geomID[lane] = hits.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
  const std::array<bool, kPacketSize> is_mover = Trace(valid, hits);

  std::array<SurfacePoint, kPacketSize> points;
  std::array<bool, kPacketSize> is_surface{};
  PacketResult result{};
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const size_t index = static_cast<size_t>(lane);
    const int sample = lane % kSamplesPerPixel;
    const bool is_own_car = packet.target[lane] >= 0;
    is_surface[index] = is_own_car || (valid[lane] && hits.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID);
    if (!is_surface[index]) continue;
    SurfacePoint& point = points[index];
    point = is_own_car ? PointOnOwnCar(tables[shot.camera], poses, packet.target[lane], sample)
                       : PointOfHit(hits, lane, is_mover[index]);
    point.sample_angle = sample_angles[lane / kSamplesPerPixel];
    if (!is_own_car) {
      point.motion = 0.25f * poses.speed * static_cast<float>(shot.exposure);
      if (point.is_ground && !movers.empty()) {
        const float left = movers.Ambient(point.position);
        point.ambient *= left;
        point.light *= left;
      }
      LightNearOwnCar(poses.body_from_world[static_cast<size_t>(sample)], point);
    }
    if (shot.with_semantics && point.is_ground && drivable[point.material].At(point.position.x(), point.position.y()))
      ++result.drivable[lane / kSamplesPerPixel];
  }
  FindSun(poses, is_surface, points);
  if (!scene.finish.empty()) Mirror(poses, is_surface, points);
  for (Color& pixel : result.pixels) pixel.setZero();
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (packet.target[lane] == kOutside) continue;
    const size_t index = static_cast<size_t>(lane);
    const Color color = is_surface[index]
                            ? Shade(scene, points[index])
                            : scene.sky.Radiance({hits.ray.dir_x[lane], hits.ray.dir_y[lane], hits.ray.dir_z[lane]});
    result.pixels[lane / kSamplesPerPixel] += color * (1.0f / kSamplesPerPixel);
  }
  return result;
}

Renderer::Renderer(const Scene& scene, const Rig& rig, double half_field_of_view)
    : parts_(std::make_unique<Parts>(scene, rig, half_field_of_view)) {}
Renderer::~Renderer() = default;

RenderedImage Renderer::Render(const Shot& shot) const {
  const SampleTable& table = parts_->tables[shot.camera];
  const double half_picture = parts_->PictureHalfTime(shot);
  const Rigid3 world_from_body = shot.world_from_body(0);
  parts_->movers.PlaceAt(shot.time - half_picture, shot.time + half_picture, world_from_body.translation);
  const auto& covers = parts_->scene.place.is_covered;
  const bool is_covered = covers && covers(world_from_body.translation);
  RenderedImage image;
  image.radiance.create(table.height, table.width, CV_32FC3);
  if (shot.with_semantics) image.drivable = cv::Mat::zeros(table.height, table.width, CV_8UC1);
  ParallelFor(static_cast<size_t>(table.height), [&](size_t row_index) {
    const FlushDenormals flush;
    const int row = static_cast<int>(row_index);
    RowPoses poses = parts_->PosesOfRow(shot, row);
    poses.is_covered = is_covered;
    float* radiance = image.radiance.ptr<float>(row);
    for (int index = 0; index < table.packets_per_row; ++index) {
      const SamplePacket& packet = table.packets[static_cast<size_t>(row * table.packets_per_row + index)];
      const int first = index * kPixelsPerPacket, count = std::min(kPixelsPerPacket, table.width - first);
      std::array<float, kPixelsPerPacket> angles{};
      std::copy_n(table.sample_angle.begin() + row * table.width + first, count, angles.begin());
      const PacketResult result = parts_->RenderPacket(shot, poses, packet, angles.data());
      for (int i = 0; i < count; ++i) {
        const float arriving = table.vignetting[static_cast<size_t>(row * table.width + first + i)];
        for (int channel = 0; channel < 3; ++channel)
          radiance[3 * (first + i) + channel] = arriving * result.pixels[i][channel];
        if (shot.with_semantics && 2 * result.drivable[i] > kSamplesPerPixel)
          image.drivable.at<std::uint8_t>(row, first + i) = 255;
      }
    }
  });
  return image;
}

cv::Mat Renderer::Mask(size_t camera) const { return parts_->tables[camera].Mask(); }

}  // namespace parkade::simulator
