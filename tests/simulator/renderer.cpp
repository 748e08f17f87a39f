#include "tests/simulator/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "tests/simulator/drivable_raster.h"
#include "tests/simulator/ground_mirror.h"
#include "tests/simulator/headlights.h"
#include "tests/simulator/sunlight.h"

namespace parkade::simulator {
namespace {

struct PacketResult {
  Color pixels[kPixelsPerPacket];
  int drivable[kPixelsPerPacket];  ///< samples on drivable ground
};

}  // namespace

struct Renderer::Parts {
  const Scene& scene;
  const Rig& rig;
  RayScene own_car;
  mutable SceneSurfaces surfaces;  ///< movers are placed anew for each picture
  Sunlight sunlight;
  std::vector<DrivableRaster> drivable;  ///< per sheet of the ground
  std::vector<SampleTable> tables;

  Parts(const Scene& scene_in, const Rig& rig_in, double half_field_of_view);
  PacketResult RenderPacket(const Shot& shot, const RowPoses& poses, const SamplePacket& packet,
                            const float* sample_angles) const;
  SurfacePoint PointOnOwnCar(const SampleTable& table, const RowPoses& poses, std::int32_t index, int sample) const;
  void LightNearOwnCar(const FastPose& body_from_world, SurfacePoint& point) const;
};

Renderer::Parts::Parts(const Scene& scene_in, const Rig& rig_in, double half_field_of_view)
    : scene(scene_in),
      rig(rig_in),
      own_car({&scene_in.own_car}),
      surfaces(scene_in),
      sunlight(scene_in, surfaces, own_car) {
  for (size_t sheet = 0; sheet < scene.place.ground.sheets().size(); ++sheet) drivable.emplace_back(scene.place, sheet);
  for (const RigCamera& camera : rig.cameras)
    tables.push_back(MakeSampleTable(camera, scene.own_car, own_car, half_field_of_view));
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
    ClearHit(hits, lane);
  }
  const LaneFlags is_mover = surfaces.Trace(valid, hits);

  SurfacePoints points;
  LaneFlags is_surface{};
  PacketResult result{};
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const size_t index = static_cast<size_t>(lane);
    const int sample = lane % kSamplesPerPixel;
    const bool is_own_car = packet.target[lane] >= 0;
    is_surface[index] = is_own_car || (valid[lane] && hits.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID);
    if (!is_surface[index]) continue;
    SurfacePoint& point = points[index];
    point = is_own_car ? PointOnOwnCar(tables[shot.camera], poses, packet.target[lane], sample)
                       : surfaces.PointOfHit(hits, lane, is_mover[index]);
    point.sample_angle = sample_angles[lane / kSamplesPerPixel];
    if (!is_own_car) {
      point.motion = 0.25f * poses.speed * static_cast<float>(shot.exposure);
      if (point.is_ground && !surfaces.movers().empty()) {
        const float left = surfaces.movers().Ambient(point.position);
        point.ambient *= left;
        point.light *= left;
      }
      LightNearOwnCar(poses.body_from_world[static_cast<size_t>(sample)], point);
    }
    if (shot.with_semantics && point.is_ground && drivable[point.material].At(point.position.x(), point.position.y()))
      ++result.drivable[lane / kSamplesPerPixel];
  }
  sunlight.FallOn(poses, is_surface, points);
  if (!scene.finish.empty()) MirrorWorld(scene, surfaces, poses, is_surface, points);
  for (Color& pixel : result.pixels) pixel.setZero();
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (packet.target[lane] == kOutside) continue;
    const size_t index = static_cast<size_t>(lane);
    const Color color =
        is_surface[index] ? Shade(scene, points[index]) : scene.sky.Radiance(DirectionOf(hits.ray, lane));
    result.pixels[lane / kSamplesPerPixel] += color * (1.0f / kSamplesPerPixel);
  }
  return result;
}

Renderer::Renderer(const Scene& scene, const Rig& rig, double half_field_of_view)
    : parts_(std::make_unique<Parts>(scene, rig, half_field_of_view)) {}
Renderer::~Renderer() = default;

RenderedImage Renderer::Render(const Shot& shot) const {
  const SampleTable& table = parts_->tables[shot.camera];
  const RigCamera& camera = parts_->rig.cameras[shot.camera];
  const double half_picture = PictureHalfTime(camera, shot);
  const Rigid3 world_from_body = shot.world_from_body(0);
  parts_->surfaces.PlaceMovers(shot.time - half_picture, shot.time + half_picture, world_from_body.translation);
  const auto& covers = parts_->scene.place.is_covered;
  const bool is_covered = covers && covers(world_from_body.translation);
  RenderedImage image;
  image.radiance.create(table.height, table.width, CV_32FC3);
  if (shot.with_semantics) image.drivable = cv::Mat::zeros(table.height, table.width, CV_8UC1);
  ParallelFor(static_cast<size_t>(table.height), [&](size_t row_index) {
    const FlushDenormals flush;
    const int row = static_cast<int>(row_index);
    RowPoses poses = PosesOfRow(camera, shot, row);
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
