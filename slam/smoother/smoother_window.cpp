#include "slam/smoother/smoother_window.h"

namespace parkade {
namespace {

using Kind = StateName::Kind;

}  // namespace

bool SmootherWindow::IsEstimated(const StateName& name) const {
  if (name.IsOfNode() || name.kind == Kind::kWheelScale) return true;
  const CameraSettings& settings = camera_settings[static_cast<size_t>(name.number)];
  return name.kind == Kind::kExtrinsics ? settings.has_extrinsics
                                        : settings.has_time_offset || settings.has_line_delay;
}

const double* SmootherWindow::ValuesOf(const StateName& name) const {
  const auto camera = static_cast<size_t>(name.number);
  switch (name.kind) {
    case Kind::kPose: return Node(name.number).pose.data();
    case Kind::kMotion: return Node(name.number).motion.data();
    case Kind::kWheelScale: return &wheel_scale;
    case Kind::kExtrinsics: return cameras[camera].extrinsics.data();
    case Kind::kTiming: return cameras[camera].timing.data();
  }
  return nullptr;
}

Bearing SmootherWindow::BearingOf(const FeatureObservation& seen, int camera) const {
  const auto index = static_cast<size_t>(camera);
  return Bearing(seen.bearing, seen.sigma * camera_noise_scales[index],
                 seen.pixel.y() - camera_settings[index].middle_row);
}

void SmootherWindow::PointViewsAtNodes() {
  for (WindowView& view : views) {
    StateNode& first = Node(view.first_node);
    CameraParameters& camera = cameras[static_cast<size_t>(view.camera)];
    ImageView& geometry = view.geometry;
    geometry.extrinsics = camera.extrinsics.data();
    geometry.timing = camera.timing.data();
    geometry.first_pose = first.pose.data();
    geometry.velocity_in_odom = Eigen::Vector3d::Map(first.motion.data());
    geometry.angular_velocity =
        view.angular_velocity - BiasFromParameters(first.motion.data()).gyroscope;
    if (view.second_node) {
      StateNode& second = Node(*view.second_node);
      geometry.second_pose = second.pose.data();
      geometry.velocity_in_odom +=
          geometry.interpolation.fraction *
          (Eigen::Vector3d::Map(second.motion.data()) - geometry.velocity_in_odom);
    }
    geometry.Update();
  }
}

std::vector<StateName> StatesOf(const WindowView& view) {
  std::vector<StateName> states{{Kind::kPose, view.first_node}};
  if (view.second_node) states.push_back({Kind::kPose, *view.second_node});
  states.push_back({Kind::kExtrinsics, view.camera});
  states.push_back({Kind::kTiming, view.camera});
  return states;
}

}  // namespace parkade
