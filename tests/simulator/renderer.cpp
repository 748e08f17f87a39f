#include "tests/simulator/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "tests/simulator/drivable_raster.h"
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

void SetRay(RTCRay16& rays, int lane, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float far) {
  rays.org_x[lane] = origin.x(), rays.org_y[lane] = origin.y(), rays.org_z[lane] = origin.z();
  rays.dir_x[lane] = direction.x(), rays.dir_y[lane] = direction.y(), rays.dir_z[lane] = direction.z();
  rays.tnear[lane] = 0, rays.tfar[lane] = far, rays.time[lane] = 0;
  rays.mask[lane] = ~0u, rays.id[lane] = static_cast<unsigned>(lane), rays.flags[lane] = 0;
}

/// A rigid motion in single precision, as a matrix.
struct FastPose {
  Eigen::Matrix3f rotation;
  Eigen::Vector3f translation;

  FastPose() = default;
  explicit FastPose(const Rigid3& motion)
      : rotation(motion.rotation.toRotationMatrix().cast<float>()), translation(motion.translation.cast<float>()) {}
  Eigen::Vector3f operator*(const Eigen::Vector3f& point) const { return rotation * point + translation; }
};

/// The car's place at the moment of each of the four samples of a row's pixels.
struct RowPoses {
  std::array<FastPose, kSamplesPerPixel> world_from_camera, world_from_body, body_from_world;
  float speed = 0;  ///< [m/s]
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
  std::vector<float> ground_ambient, object_ambient;
  std::vector<DrivableRaster> drivable;  ///< per sheet of the ground
  std::vector<SampleTable> tables;
  std::array<Eigen::Vector3f, kSamplesPerPixel> to_sun;

  Parts(const Scene& scene_in, const Rig& rig_in, double half_field_of_view);
  RowPoses PosesOfRow(const Shot& shot, int row) const;
  PacketResult RenderPacket(const Shot& shot, const RowPoses& poses, const SamplePacket& packet,
                            const float* sample_angles) const;
  SurfacePoint PointInWorld(const RTCRayHit16& hits, int lane) const;
  SurfacePoint PointOnOwnCar(const SampleTable& table, const RowPoses& poses, std::int32_t hit, int sample) const;
  void FindSun(const RowPoses& poses, const std::array<bool, kPacketSize>& is_surface,
               std::array<SurfacePoint, kPacketSize>& points) const;
  void DarkenNearOwnCar(const FastPose& body_from_world, SurfacePoint& point) const;
};

Renderer::Parts::Parts(const Scene& scene_in, const Rig& rig_in, double half_field_of_view)
    : scene(scene_in), rig(rig_in), world({&scene.ground, &scene.objects}), own_car({&scene.own_car}) {
  for (size_t sheet = 0; sheet < scene.place.ground.sheets().size(); ++sheet) drivable.emplace_back(scene.place, sheet);
  ground_ambient = world.VertexAmbient(scene.ground, 4, 1);
  object_ambient = world.VertexAmbient(scene.objects, 4, 2);
  for (const RigCamera& camera : rig.cameras)
    tables.push_back(MakeSampleTable(camera, scene.own_car, own_car, half_field_of_view));
  const Eigen::Vector3f sun = scene.sky.sun_direction(), u = sun.unitOrthogonal(), v = sun.cross(u);
  for (size_t i = 0; i < kSamplesPerPixel; ++i)
    to_sun[i] = (sun + Sky::kSunRadius * (kSunOffsets[i][0] * u + kSunOffsets[i][1] * v)).normalized();
}

RowPoses Renderer::Parts::PosesOfRow(const Shot& shot, int row) const {
  const RigCamera& camera = rig.cameras[shot.camera];
  const double row_offset = camera.line_delay * (row - (camera.model.height() - 1) / 2.0);
  RowPoses poses;
  Eigen::Vector3d first = Eigen::Vector3d::Zero(), last = first;
  for (size_t sample = 0; sample < kSamplesPerPixel; ++sample) {
    const Rigid3 world_from_body = shot.world_from_body(row_offset + kMoments[sample] * shot.exposure);
    poses.world_from_body[sample] = FastPose(world_from_body);
    poses.body_from_world[sample] = FastPose(world_from_body.Inverse());
    poses.world_from_camera[sample] = FastPose(world_from_body * camera.body_from_camera);
    if (sample == 1) last = world_from_body.translation;
    if (sample == 2) first = world_from_body.translation;
  }
  if (shot.exposure > 0) poses.speed = static_cast<float>((last - first).norm() / (0.75 * shot.exposure));
  return poses;
}

SurfacePoint Renderer::Parts::PointInWorld(const RTCRayHit16& hits, int lane) const {
  const bool is_ground = hits.hit.geomID[lane] == kGround;
  const Mesh& mesh = is_ground ? scene.ground : scene.objects;
  const std::vector<float>& ambient = is_ground ? ground_ambient : object_ambient;
  const auto& [a, b, c] = mesh.triangles[hits.hit.primID[lane]];
  const float u = hits.hit.u[lane], v = hits.hit.v[lane], w = 1 - u - v;
  SurfacePoint point;
  point.ray = {hits.ray.dir_x[lane], hits.ray.dir_y[lane], hits.ray.dir_z[lane]};
  point.distance = hits.ray.tfar[lane];
  point.position =
      Eigen::Vector3f(hits.ray.org_x[lane], hits.ray.org_y[lane], hits.ray.org_z[lane]) + point.distance * point.ray;
  point.flat_normal = Eigen::Vector3f(hits.hit.Ng_x[lane], hits.hit.Ng_y[lane], hits.hit.Ng_z[lane]).normalized();
  point.normal = (w * mesh.normals[a] + u * mesh.normals[b] + v * mesh.normals[c]).normalized();
  // A surface seen from its back is lit as one that faces the eye.
  if (point.ray.dot(point.flat_normal) > 0) point.flat_normal = -point.flat_normal;
  if (point.normal.dot(point.flat_normal) < 0) point.normal = -point.normal;
  point.ambient = 0.12f + 0.88f * (w * ambient[a] + u * ambient[b] + v * ambient[c]);
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
  point.ambient = 0.8f;
  point.material = hit.material;
  return point;
}

void Renderer::Parts::FindSun(const RowPoses& poses, const std::array<bool, kPacketSize>& is_surface,
                              std::array<SurfacePoint, kPacketSize>& points) const {
  constexpr float kLift = 0.004f;          // [m] off the surface, against its own shadow
  constexpr float kOwnShadowReach = 8.0f;  // [m] from the body's origin
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
    SetRay(in_world, lane, origin, to_sun[sample], 400);
    valid[lane] = -1;
    is_any = true;
    const FastPose& body_from_world = poses.body_from_world[sample];
    const Eigen::Vector3f origin_in_body = body_from_world * origin;
    if (origin_in_body.squaredNorm() > kOwnShadowReach * kOwnShadowReach) continue;
    SetRay(in_body, lane, origin_in_body, body_from_world.rotation * to_sun[sample], 20);
    valid_near[lane] = -1;
    is_any_near = true;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  if (is_any) rtcOccluded16(valid, world.scene(), &context, &in_world);
  if (is_any_near) rtcOccluded16(valid_near, own_car.scene(), &context, &in_body);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const bool is_hidden = (valid[lane] && in_world.tfar[lane] < 0) || (valid_near[lane] && in_body.tfar[lane] < 0);
    if (is_hidden) points[static_cast<size_t>(lane)].sun = 0;
  }
}

/// The car hides sky from the ground beside and below it.
void Renderer::Parts::DarkenNearOwnCar(const FastPose& body_from_world, SurfacePoint& point) const {
  const Eigen::Vector3f in_body = body_from_world * point.position;
  const float beyond_x = std::max({-0.7f - in_body.x(), in_body.x() - 3.2f, 0.0f});
  const float beyond_y = std::max(std::abs(in_body.y()) - 0.85f, 0.0f);
  const float away = std::hypot(beyond_x, beyond_y) + std::max(0.0f, in_body.z());
  if (away < 3) point.ambient *= 1 - 0.7f * std::exp(-away / 0.4f);
}

PacketResult Renderer::Parts::RenderPacket(const Shot& shot, const RowPoses& poses, const SamplePacket& packet,
                                           const float* sample_angles) const {
  alignas(64) RTCRayHit16 hits;
  alignas(64) int valid[kPacketSize];
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const FastPose& world_from_camera = poses.world_from_camera[static_cast<size_t>(lane % kSamplesPerPixel)];
    valid[lane] = packet.target[lane] == kWorld ? -1 : 0;
    const Eigen::Vector3f direction(packet.x[lane], packet.y[lane], packet.z[lane]);
    SetRay(hits.ray, lane, world_from_camera.translation, world_from_camera.rotation * direction, 1000);
    hits.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    hits.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, world.scene(), &context, &hits);

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
    point =
        is_own_car ? PointOnOwnCar(tables[shot.camera], poses, packet.target[lane], sample) : PointInWorld(hits, lane);
    point.sample_angle = sample_angles[lane / kSamplesPerPixel];
    if (!is_own_car) {
      point.motion = 0.25f * poses.speed * static_cast<float>(shot.exposure);
      DarkenNearOwnCar(poses.body_from_world[static_cast<size_t>(sample)], point);
    }
    if (shot.with_semantics && point.is_ground && drivable[point.material].At(point.position.x(), point.position.y()))
      ++result.drivable[lane / kSamplesPerPixel];
  }
  FindSun(poses, is_surface, points);
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
  RenderedImage image;
  image.radiance.create(table.height, table.width, CV_32FC3);
  if (shot.with_semantics) image.drivable = cv::Mat::zeros(table.height, table.width, CV_8UC1);
  ParallelFor(static_cast<size_t>(table.height), [&](size_t row_index) {
    const FlushDenormals flush;
    const int row = static_cast<int>(row_index);
    const RowPoses poses = parts_->PosesOfRow(shot, row);
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
