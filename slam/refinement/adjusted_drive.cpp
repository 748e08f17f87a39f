#include "slam/refinement/adjusted_drive.h"

#include <algorithm>
#include <cassert>

namespace parkade {

AdjustedDrive::AdjustedDrive(const DriveMeasurements& measurements,
                             const std::vector<MotionState>& start, size_t max_landmarks)
    : arena(start.size() * (kPoseSize + kMotionSize) +
            measurements.shared.cameras.size() * (kPoseSize + kTimingSize) + 1 + kSiteSize +
            max_landmarks * kLandmarkSize),
      camera_priors(measurements.shared.camera_priors) {
  assert(start.size() == measurements.nodes.size() && !start.empty());
  AddNodes(measurements, start);
  AddImages(measurements);
}

void AdjustedDrive::AddNodes(const DriveMeasurements& measurements,
                             const std::vector<MotionState>& start) {
  for (size_t i = 0; i < start.size(); ++i) {
    AdjustedNode& node = nodes.emplace_back();
    node.time = start[i].time;
    node.pose = arena.Add(std::array<double, kPoseSize>{});
    node.motion = arena.Add(std::array<double, kMotionSize>{});
    StateToParameters(start[i], node.pose, node.motion);
    node.interval = measurements.IntervalBefore(i);
    if (node.interval)
      node.interval->imu.Reintegrate({start[i].gyroscope_bias, start[i].accelerometer_bias});
  }
  for (const CameraParameters& camera : measurements.shared.cameras) {
    CameraBlocks& blocks = cameras.emplace_back();
    blocks.extrinsics = arena.Add(camera.extrinsics);
    blocks.timing = arena.Add(camera.timing);
  }
  wheel_scale = arena.Add(std::array<double, 1>{measurements.shared.wheel_scale});
  site_from_odom = arena.Add(std::array<double, kSiteSize>{});
}

void AdjustedDrive::AddImages(const DriveMeasurements& measurements) {
  const std::int64_t first_number = measurements.nodes.front().number;
  const auto index_of = [&](std::int64_t number) {
    return std::min(static_cast<size_t>(std::max<std::int64_t>(number - first_number, 0)),
                    nodes.size() - 1);
  };
  images.reserve(measurements.num_images());
  for (size_t i = 0; i < measurements.num_images(); ++i) {
    const RecordedImage recorded = measurements.Image(i);
    AdjustedImage& image = images.emplace_back();
    image.camera = recorded.camera;
    image.first = index_of(recorded.first_node);
    image.second = recorded.second_node ? index_of(*recorded.second_node) : image.first;
    image.angular_velocity = recorded.angular_velocity;
    const CameraSigmas& prior = camera_priors[static_cast<size_t>(recorded.camera)];
    const CameraBlocks& camera = cameras[static_cast<size_t>(recorded.camera)];
    ImageView& view = image.geometry;
    view.interpolation = recorded.interpolation;
    view.first_pose = nodes[image.first].pose;
    if (image.second != image.first) view.second_pose = nodes[image.second].pose;
    view.extrinsics = camera.extrinsics;
    view.timing = camera.timing;
    view.time_offset = recorded.time_offset;
    view.holds_time_offset = !(prior.time_offset > 0);
    view.holds_line_delay = !(prior.line_delay > 0);
  }
  PointImages();
}

void AdjustedDrive::PointImages() {
  for (AdjustedImage& image : images) {
    const Eigen::Vector3d first = Eigen::Vector3d::Map(nodes[image.first].motion);
    const Eigen::Vector3d second = Eigen::Vector3d::Map(nodes[image.second].motion);
    ImageView& view = image.geometry;
    view.velocity_in_odom = first + view.interpolation.fraction * (second - first);
    view.angular_velocity =
        image.angular_velocity - BiasFromParameters(nodes[image.first].motion).gyroscope;
    view.Update();
  }
}

}  // namespace parkade
