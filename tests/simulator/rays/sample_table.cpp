#include "tests/simulator/rays/sample_table.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/parallel.h"

namespace parkade::simulator {
namespace {

/// Natural fall-off of a lens at an angle to its axis: what fisheyes of this kind show.
float Vignetting(double angle, double half_field_of_view) {
  const double relative = angle / half_field_of_view;
  const double rim = std::clamp((1 - relative) / 0.03, 0.0, 1.0);
  return static_cast<float>((1 - 0.45 * relative * relative * relative) * rim);
}

std::optional<OwnCarHit> HitOwnCar(const Mesh& own_car, const RayScene& rays,
                                   const Rigid3& body_from_camera,
                                   const Eigen::Vector3d& direction_in_camera) {
  const Eigen::Vector3f origin = body_from_camera.translation.cast<float>();
  const Eigen::Vector3f direction = (body_from_camera.rotation * direction_in_camera).cast<float>();
  RTCRayHit query{};
  query.ray.org_x = origin.x(), query.ray.org_y = origin.y(), query.ray.org_z = origin.z();
  query.ray.dir_x = direction.x(), query.ray.dir_y = direction.y(), query.ray.dir_z = direction.z();
  query.ray.tfar = 20;
  query.ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(rays.scene(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const auto& triangle = own_car.triangles[query.hit.primID];
  const Eigen::Vector3f normal = (1 - query.hit.u - query.hit.v) * own_car.normals[triangle[0]] +
                                 query.hit.u * own_car.normals[triangle[1]] +
                                 query.hit.v * own_car.normals[triangle[2]];
  return OwnCarHit{origin + query.ray.tfar * direction, normal.normalized(), query.ray.tfar,
                   own_car.triangle_materials[query.hit.primID]};
}

/// One image row's packets and hits (indices into its own hits).
struct TableRow {
  std::vector<SamplePacket> packets;
  std::vector<float> angles, vignetting;
  std::vector<OwnCarHit> hits;
};

TableRow MakeRow(const RigCamera& camera, const Mesh& own_car, const RayScene& rays,
                 double half_field_of_view, int row) {
  const CameraModel& model = camera.model;
  TableRow made;
  made.packets.resize(
      static_cast<size_t>((model.width() + kPixelsPerPacket - 1) / kPixelsPerPacket));
  for (SamplePacket& packet : made.packets)
    std::fill(std::begin(packet.target), std::end(packet.target), kOutside);
  for (int column = 0; column < model.width(); ++column) {
    const std::optional<Eigen::Vector3d> bearing = model.Unproject({column, row});
    const double angle = bearing ? std::acos(std::clamp(bearing->z(), -1.0, 1.0)) : M_PI;
    made.vignetting.push_back(Vignetting(angle, half_field_of_view));
    made.angles.push_back(
        static_cast<float>(0.5 / model.PixelsPerRadian({column, row}).value_or(1e3)));
    if (made.vignetting.back() <= 0) continue;
    SamplePacket& packet = made.packets[static_cast<size_t>(column / kPixelsPerPacket)];
    for (size_t sample = 0; sample < kSamplesPerPixel; ++sample) {
      const auto [right, down] = kSampleOffsets[sample];
      const auto direction = model.Unproject({column + double{right}, row + double{down}});
      if (!direction) continue;
      const size_t lane =
          static_cast<size_t>(column % kPixelsPerPacket) * kSamplesPerPixel + sample;
      packet.x[lane] = static_cast<float>(direction->x());
      packet.y[lane] = static_cast<float>(direction->y());
      packet.z[lane] = static_cast<float>(direction->z());
      packet.target[lane] = kWorld;
      if (const auto hit = HitOwnCar(own_car, rays, camera.body_from_camera, *direction)) {
        packet.target[lane] = static_cast<std::int32_t>(made.hits.size());
        made.hits.push_back(*hit);
      }
    }
  }
  return made;
}

}  // namespace

SampleTable MakeSampleTable(const RigCamera& camera, const Mesh& own_car,
                            const RayScene& own_car_rays, double half_field_of_view) {
  const std::vector<TableRow> rows =
      ParallelMap(static_cast<size_t>(camera.model.height()), [&](size_t row) {
        return MakeRow(camera, own_car, own_car_rays, half_field_of_view, static_cast<int>(row));
      });
  SampleTable table;
  table.width = camera.model.width();
  table.height = camera.model.height();
  table.packets_per_row = static_cast<int>(rows.front().packets.size());
  for (const TableRow& row : rows) {
    const std::int32_t first = static_cast<std::int32_t>(table.own_car_hits.size());
    for (SamplePacket packet : row.packets) {
      for (std::int32_t& target : packet.target) target += target >= 0 ? first : 0;
      table.packets.push_back(packet);
    }
    table.sample_angle.insert(table.sample_angle.end(), row.angles.begin(), row.angles.end());
    table.vignetting.insert(table.vignetting.end(), row.vignetting.begin(), row.vignetting.end());
    table.own_car_hits.insert(table.own_car_hits.end(), row.hits.begin(), row.hits.end());
  }
  return table;
}

cv::Mat SampleTable::Mask() const {
  cv::Mat mask(height, width, CV_8UC1);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const SamplePacket& packet =
          packets[static_cast<size_t>(row * packets_per_row + column / kPixelsPerPacket)];
      bool is_usable = vignetting[static_cast<size_t>(row * width + column)] > 0.3f;
      for (int sample = 0; sample < kSamplesPerPixel; ++sample)
        is_usable = is_usable &&
                    packet.target[column % kPixelsPerPacket * kSamplesPerPixel + sample] == kWorld;
      mask.at<std::uint8_t>(row, column) = is_usable ? 255 : 0;
    }
  }
  // What is hidden by a hand's breadth of paint today is seen with a slightly turned camera
  // tomorrow.
  cv::erode(mask, mask, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}), {-1, -1}, 1,
            cv::BORDER_REPLICATE);
  return mask;
}

}  // namespace parkade::simulator
