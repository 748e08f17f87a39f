#include "tests/simulator/render/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/parallel.h"
#include "tests/simulator/render/ground_mirror.h"
#include "tests/simulator/render/lens_flare.h"
#include "tests/simulator/render/pixel_samples.h"
#include "tests/simulator/render/sunlight.h"
#include "tests/simulator/scenes/drivable_raster.h"
#include "tests/simulator/scenes/headlights.h"

namespace parkade::simulator {
namespace {

using PixelsOfPacket = std::array<PixelSamples*, kPixelsPerPacket>;

/// The rays of samples `first` to `first` + 3 of pixels of which a table has the first four: the
/// lens is taken to be even within a pixel, a thousandth of a pixel off at most.
void AddSamples(const SamplePacket& table, int pixel_in_table, int first, int pixel,
                SamplePacket& packet) {
  const auto ray = [&](int sample) {
    const int lane = pixel_in_table * kSamplesPerPixel + sample;
    return Eigen::Vector3f(table.x[lane], table.y[lane], table.z[lane]);
  };
  // The table's samples lie in a square: two diagonals, at right angles.
  const Eigen::Vector3f middle = 0.25f * (ray(0) + ray(1) + ray(2) + ray(3)), a = ray(3) - ray(0),
                        b = ray(1) - ray(2);
  const Eigen::Vector3f by_column = (0.25f * a + 0.75f * b) / 0.625f,
                        by_row = (0.75f * a - 0.25f * b) / 0.625f;
  for (int sample = 0; sample < kSamplesPerPixel; ++sample) {
    const auto [right, down] = kSampleOffsets[static_cast<size_t>(first + sample)];
    const Eigen::Vector3f direction = (middle + right * by_column + down * by_row).normalized();
    const int lane = pixel * kSamplesPerPixel + sample;
    packet.x[lane] = direction.x(), packet.y[lane] = direction.y(), packet.z[lane] = direction.z();
    packet.target[lane] = kWorld;
  }
}

bool SeesWorldAlone(const SamplePacket& packet, int pixel) {
  const std::int32_t* target = packet.target + pixel * kSamplesPerPixel;
  return std::all_of(target, target + kSamplesPerPixel,
                     [](std::int32_t of_sample) { return of_sample == kWorld; });
}

/// The number of the class that most samples saw; those without a surface saw the sky.
std::uint8_t MostSeen(const PixelSamples& pixel) {
  auto classes = pixel.classes;
  const int seen = std::accumulate(classes.begin(), classes.end(), 0);
  classes[static_cast<size_t>(SurfaceClass::kStructure)] +=
      static_cast<std::uint8_t>(pixel.count - seen);
  return static_cast<std::uint8_t>(std::max_element(classes.begin(), classes.end()) -
                                   classes.begin());
}

}  // namespace

struct Renderer::Parts {
  const Scene& scene;
  const Rig& rig;
  RayScene own_car;
  mutable SceneSurfaces surfaces;  ///< movers are placed anew for each image
  Sunlight sunlight;
  std::vector<DrivableRaster> drivable;  ///< per sheet of the ground
  std::vector<SampleTable> tables;

  Parts(const Scene& scene_in, const Rig& rig_in, double half_field_of_view);
  std::vector<PixelSamples> RenderRow(const Shot& shot, const RowPoses& poses, int row) const;
  std::vector<int> EdgesOfRow(const Shot& shot, const ImageSamples& rows, int row) const;
  void RenderEdges(const Shot& shot, const RowPoses& poses, int row,
                   const std::vector<int>& columns, std::vector<PixelSamples>& pixels) const;
  RenderedImage Image(const Shot& shot, const ImageSamples& rows) const;
  void Flare(const Shot& shot, const MomentPose& pose, cv::Mat& radiance) const;
  void RenderPacket(const Shot& shot, const PacketPoses& poses, const SamplePacket& packet,
                    const std::array<float, kPixelsPerPacket>& sample_angles,
                    const PixelsOfPacket& pixels) const;
  SurfacePoint PointOnOwnCar(const OwnCarHit& hit, const MomentPose& pose, bool is_covered) const;
  void LightNearOwnCar(const FastPose& body_from_world, SurfacePoint& point) const;
  SurfaceClass ClassOf(const SurfacePoint& point) const;
  void NoteSemantics(Semantics semantics, const SurfacePoint& point, bool is_own_car,
                     PixelSamples& pixel) const;
  bool IsDrivable(const SurfacePoint& point) const {
    return point.is_ground && drivable[point.material].At(point.position.x(), point.position.y());
  }
  bool IsLevelGround(const SurfacePoint& point) const;
};

Renderer::Parts::Parts(const Scene& scene_in, const Rig& rig_in, double half_field_of_view)
    : scene(scene_in),
      rig(rig_in),
      own_car({&scene_in.own_car}),
      surfaces(scene_in),
      sunlight(scene_in, surfaces, own_car) {
  for (size_t sheet = 0; sheet < scene.place.ground.sheets().size(); ++sheet)
    drivable.emplace_back(scene.place, sheet);
  for (const RigCamera& camera : rig.cameras)
    tables.push_back(MakeSampleTable(camera, scene.own_car, own_car, half_field_of_view));
}

SurfacePoint Renderer::Parts::PointOnOwnCar(const OwnCarHit& hit, const MomentPose& pose,
                                            bool is_covered) const {
  SurfacePoint point;
  point.position = pose.world_from_body * hit.point_in_body;
  point.normal = point.flat_normal = pose.world_from_body.rotation * hit.normal_in_body;
  point.ray = (point.position - pose.world_from_camera.translation).normalized();
  point.distance = hit.distance;
  point.ambient = is_covered ? 0.03f : 0.8f;
  point.openness = is_covered ? 0.0f : 1.0f;
  point.light =
      scene.lamps.Irradiance(point.position, point.normal) + (is_covered ? scene.bounce : Gray(0));
  point.material = hit.material;
  return point;
}

/// What a network may take for a road: level, and hardly higher than the road.
bool Renderer::Parts::IsLevelGround(const SurfacePoint& point) const {
  constexpr float kLevel = 0.9F, kMaxHeight = 0.25F;  // cosine of the slope, [m]
  if (point.is_ground || point.flat_normal.z() <= kLevel) return false;
  const Eigen::Vector3d position = point.position.cast<double>();
  const double road = scene.place.ground.Height(position.head<2>(), position.z());
  return position.z() - road < static_cast<double>(kMaxHeight);
}

SurfaceClass Renderer::Parts::ClassOf(const SurfacePoint& point) const {
  if (!point.is_ground) return scene.materials[point.material].surface;
  if (!IsDrivable(point)) return SurfaceClass::kVehicle;  // all else that stands hides its ground
  const float x = point.position.x(), y = point.position.y();
  return scene.ground_colors[point.material].IsMarking(x, y) ? SurfaceClass::kMarking
                                                             : SurfaceClass::kDrivable;
}

void Renderer::Parts::NoteSemantics(Semantics semantics, const SurfacePoint& point, bool is_own_car,
                                    PixelSamples& pixel) const {
  if (semantics == Semantics::kClasses) {
    const SurfaceClass found = is_own_car ? SurfaceClass::kOwnCar : ClassOf(point);
    ++pixel.classes[static_cast<size_t>(found)];
  } else if (semantics != Semantics::kNone && !is_own_car) {
    pixel.num_drivable +=
        IsDrivable(point) || (semantics == Semantics::kLevelGround && IsLevelGround(point));
  }
}

/// The car hides light from the ground beside and below it, and its headlights shine ahead.
void Renderer::Parts::LightNearOwnCar(const FastPose& body_from_world, SurfacePoint& point) const {
  const Eigen::Vector3f in_body = body_from_world * point.position;
  const float beyond_x = std::max({-0.7f - in_body.x(), in_body.x() - 3.2f, 0.0f});
  const float beyond_y = std::max(std::abs(in_body.y()) - 0.85f, 0.0f);
  const float away = std::hypot(beyond_x, beyond_y) + std::max(0.0f, in_body.z());
  if (away < 3 && !scene.own_car.triangles.empty()) {
    const float left = 1 - 0.7f * std::exp(-away / 0.4f);
    point.ambient *= left;
    point.light *= left;
  }
  if (scene.has_headlights)
    point.light += HeadlightIrradiance(in_body, body_from_world.rotation * point.normal);
}

void Renderer::Parts::RenderPacket(const Shot& shot, const PacketPoses& poses,
                                   const SamplePacket& packet,
                                   const std::array<float, kPixelsPerPacket>& sample_angles,
                                   const PixelsOfPacket& pixels) const {
  alignas(64) RTCRayHit16 hits;
  alignas(64) int valid[kPacketSize];
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const MomentPose& pose = poses.Of(lane);
    valid[lane] = packet.target[lane] == kWorld ? -1 : 0;
    const Eigen::Vector3f direction(packet.x[lane], packet.y[lane], packet.z[lane]);
    SetRay(hits.ray, lane, pose.world_from_camera.translation,
           pose.world_from_camera.rotation * direction, 1000, pose.time);
    ClearHit(hits, lane);
  }
  const LaneFlags is_mover = surfaces.Trace(valid, hits);

  SurfacePoints points;
  LaneFlags is_surface{};
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const size_t index = static_cast<size_t>(lane), pixel = index / kSamplesPerPixel;
    const bool is_own_car = packet.target[lane] >= 0;
    is_surface[index] =
        is_own_car || (valid[lane] && hits.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID);
    if (!is_surface[index]) continue;
    SurfacePoint& point = points[index];
    point = is_own_car
                ? PointOnOwnCar(
                      tables[shot.camera].own_car_hits[static_cast<size_t>(packet.target[lane])],
                      poses.Of(lane), poses.row.is_covered)
                : surfaces.PointOfHit(hits, lane, is_mover[index]);
    point.sample_angle = sample_angles[pixel];
    if (!is_own_car) {
      point.motion = 0.25f * poses.row.speed * static_cast<float>(shot.exposure);
      if (point.is_ground && !surfaces.movers().empty()) {
        const float left = surfaces.movers().Ambient(point.position);
        point.ambient *= left;
        point.light *= left;
      }
      LightNearOwnCar(poses.Of(lane).body_from_world, point);
    }
    NoteSemantics(shot.semantics, point, is_own_car, *pixels[pixel]);
  }
  sunlight.FallOn(poses, is_surface, points);
  if (!scene.finish.empty()) MirrorWorld(scene, surfaces, poses, is_surface, points);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (packet.target[lane] == kOutside) continue;
    const size_t index = static_cast<size_t>(lane);
    PixelSamples& pixel = *pixels[index / kSamplesPerPixel];
    if (is_surface[index])
      pixel.Add(Shade(scene, points[index]), &points[index]);
    else
      pixel.Add(scene.sky.Radiance(DirectionOf(hits.ray, lane)), nullptr);
  }
}

std::vector<PixelSamples> Renderer::Parts::RenderRow(const Shot& shot, const RowPoses& poses,
                                                     int row) const {
  const SampleTable& table = tables[shot.camera];
  // The last packet may be wider than the image.
  std::vector<PixelSamples> pixels(static_cast<size_t>(table.packets_per_row * kPixelsPerPacket));
  for (int column = 0; column < table.width; column += kPixelsPerPacket) {
    PacketPoses packet_poses{poses};
    std::array<float, kPixelsPerPacket> sample_angles{};
    PixelsOfPacket targets{};
    for (int pixel = 0; pixel < kPixelsPerPacket; ++pixel) {
      const size_t index = static_cast<size_t>(pixel);
      targets[index] = &pixels[static_cast<size_t>(column) + index];
      if (column + pixel < table.width)
        sample_angles[index] = table.SampleAngle(column + pixel, row);
      packet_poses.SetMoments(pixel, PixelMoments(column + pixel, row), 0);
    }
    RenderPacket(shot, packet_poses, table.PacketOf(column, row), sample_angles, targets);
  }
  pixels.resize(static_cast<size_t>(table.width));
  return pixels;
}

/// Columns of the pixels that want more samples.
std::vector<int> Renderer::Parts::EdgesOfRow(const Shot& shot, const ImageSamples& rows,
                                             int row) const {
  const SampleTable& table = tables[shot.camera];
  std::vector<int> columns;
  for (int column = 0; column < table.width; ++column)
    if (SeesWorldAlone(table.PacketOf(column, row), column % kPixelsPerPacket) &&
        HasEdge(rows, static_cast<size_t>(row), static_cast<size_t>(column)))
      columns.push_back(column);
  return columns;
}

/// Adds twelve samples to each pixel at an edge.
void Renderer::Parts::RenderEdges(const Shot& shot, const RowPoses& poses, int row,
                                  const std::vector<int>& columns,
                                  std::vector<PixelSamples>& pixels) const {
  const SampleTable& table = tables[shot.camera];
  PixelSamples unused;
  for (size_t begin = 0; begin < columns.size(); begin += kPixelsPerPacket) {
    for (int first = kSamplesPerPixel; first < kSamplesPerEdgePixel; first += kSamplesPerPixel) {
      SamplePacket packet{};
      std::fill(std::begin(packet.target), std::end(packet.target), kOutside);
      PacketPoses packet_poses{poses};
      std::array<float, kPixelsPerPacket> sample_angles{};
      PixelsOfPacket targets;
      targets.fill(&unused);
      for (size_t pixel = 0; pixel < kPixelsPerPacket && begin + pixel < columns.size(); ++pixel) {
        const int column = columns[begin + pixel];
        targets[pixel] = &pixels[static_cast<size_t>(column)];
        sample_angles[pixel] = table.SampleAngle(column, row);
        packet_poses.SetMoments(static_cast<int>(pixel), PixelMoments(column, row), first);
        AddSamples(table.PacketOf(column, row), column % kPixelsPerPacket, first,
                   static_cast<int>(pixel), packet);
      }
      RenderPacket(shot, packet_poses, packet, sample_angles, targets);
    }
  }
}

RenderedImage Renderer::Parts::Image(const Shot& shot, const ImageSamples& rows) const {
  const SampleTable& table = tables[shot.camera];
  RenderedImage image;
  image.radiance = cv::Mat::zeros(table.height, table.width, CV_32FC3);
  const bool has_classes = shot.semantics == Semantics::kClasses;
  if (shot.semantics != Semantics::kNone)
    image.mask = cv::Mat(table.height, table.width, CV_8UC1, cv::Scalar(has_classes ? 255 : 0));
  for (int row = 0; row < table.height; ++row) {
    for (int column = 0; column < table.width; ++column) {
      const PixelSamples& pixel = rows[static_cast<size_t>(row)][static_cast<size_t>(column)];
      if (pixel.count == 0) continue;
      // A sample outside the lens is dark.
      const int count = std::max(pixel.count, kSamplesPerPixel);
      const Color arriving =
          pixel.light * (table.Vignetting(column, row) / static_cast<float>(count));
      image.radiance.at<cv::Vec3f>(row, column) = {arriving[0], arriving[1], arriving[2]};
      // Halves go one way in every other pixel: taken for undrivable, outlines would be an eighth
      // of a pixel off.
      const int halves = (row + column) % 2;
      if (has_classes)
        image.mask.at<std::uint8_t>(row, column) = MostSeen(pixel);
      else if (!image.mask.empty() && 2 * pixel.num_drivable + halves > count)
        image.mask.at<std::uint8_t>(row, column) = 255;
    }
  }
  return image;
}

/// Of the sun, where it shines into the lens.
void Renderer::Parts::Flare(const Shot& shot, const MomentPose& pose, cv::Mat& radiance) const {
  constexpr float kSideways = -0.07f;  // cosine from the axis: light from behind does not enter
  const FastPose& camera = pose.world_from_camera;
  const Eigen::Vector3f to_sun = camera.rotation.transpose() * scene.sky.sun_direction();
  if (to_sun.z() < kSideways || !sunlight.Shines(camera.translation, pose.time)) return;
  AddFlare(to_sun, scene.sky.sun_irradiance() * static_cast<float>(shot.flare),
           rig.cameras[shot.camera].model, tables[shot.camera], radiance);
}

Renderer::Renderer(const Scene& scene, const Rig& rig, double half_field_of_view)
    : parts_(std::make_unique<Parts>(scene, rig, half_field_of_view)) {}
Renderer::~Renderer() = default;

RenderedImage Renderer::Render(const Shot& shot) const {
  const SampleTable& table = parts_->tables[shot.camera];
  const RigCamera& camera = parts_->rig.cameras[shot.camera];
  const double half_image = ImageHalfTime(camera, shot);
  const Rigid3 world_from_body = shot.world_from_body(0);
  parts_->surfaces.PlaceMovers(shot.time - half_image, shot.time + half_image,
                               world_from_body.translation);
  const auto& covers = parts_->scene.place.is_covered;
  const bool is_covered = covers && covers(world_from_body.translation);
  const size_t num_rows = static_cast<size_t>(table.height);
  std::vector<RowPoses> poses(num_rows);
  ImageSamples rows(num_rows);
  std::vector<std::vector<int>> edges(num_rows);
  const auto for_all_rows = [&](auto&& of_row) {
    ParallelFor(num_rows, [&](size_t row) {
      const FlushDenormals flush;
      of_row(row, static_cast<int>(row));
    });
  };
  for_all_rows([&](size_t index, int row) {
    poses[index] = PosesOfRow(camera, shot, row);
    poses[index].is_covered = is_covered;
    rows[index] = parts_->RenderRow(shot, poses[index], row);
  });
  for_all_rows([&](size_t index, int row) { edges[index] = parts_->EdgesOfRow(shot, rows, row); });
  for_all_rows([&](size_t index, int row) {
    parts_->RenderEdges(shot, poses[index], row, edges[index], rows[index]);
  });
  RenderedImage image = parts_->Image(shot, rows);
  if (shot.flare > 0) parts_->Flare(shot, poses[num_rows / 2].moments.front(), image.radiance);
  return image;
}

cv::Mat Renderer::Mask(size_t camera) const { return parts_->tables[camera].Mask(); }

}  // namespace parkade::simulator
