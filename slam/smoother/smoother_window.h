#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "slam/factors/bearing_cost.h"
#include "slam/factors/imu_preintegration.h"
#include "slam/factors/linear_prior.h"
#include "slam/factors/node_parameters.h"
#include "slam/factors/wheel_preintegration.h"
#include "slam/smoother/node_conditional.h"
#include "slam/tracking/feature_track.h"

namespace parkade {

/// What the sensors say about the time from one node to the next.
struct NodeInterval {
  ImuPreintegration imu;
  std::optional<WheelPreintegration> wheels;
  bool is_still = false;  ///< the car stood
};

/// An instant whose state is estimated.
struct StateNode {
  std::int64_t number = 0;
  Timestamp time;
  std::array<double, kPoseSize> pose{};
  std::array<double, kMotionSize> motion{};
  std::optional<NodeInterval> interval;  ///< since the node before; empty at the very first

  MotionState State() const { return StateFromParameters(time, pose.data(), motion.data()); }
};

/// One image in the window. Nodes are named by number; the pointers of
/// `geometry` are set for as long as they are needed.
struct WindowView {
  Timestamp time;
  int camera = 0;
  std::int64_t first_node = 0;
  std::optional<std::int64_t> second_node;  ///< empty: the image is at the first node
  ImageView geometry;
  Eigen::Vector3d angular_velocity;  ///< [rad/s] as the gyroscope says, bias included
};

struct TrackObservation {
  WindowView* view = nullptr;
  Bearing bearing;
  std::unique_ptr<BearingCost> cost;  ///< only while the track has a landmark
};

/// One tracked point and, once its distance can be told, its landmark.
struct Track {
  std::int64_t number = 0;
  int camera = 0;  ///< that found it first
  std::vector<TrackObservation> observations;
  bool has_landmark = false;
  LandmarkRay ray;
  std::array<double, kLandmarkSize> landmark{};
  int num_rejections = 0;
  int num_consumed = 0;  ///< observations already condensed into the prior
  Timestamp first_time;  ///< of the first observation ever
  Timestamp last_time;   ///< of the last, kept or not
};

/// What of one camera's calibration is estimated, and what was known of it before.
struct CameraSettings {
  double middle_row = 0;  ///< [px]
  CameraSigmas prior;
  bool has_extrinsics = true;   ///< estimated
  bool has_time_offset = true;  ///< estimated
  bool has_line_delay = false;  ///< estimated
};

/// All that is estimated at a time: the states of the last nodes, the landmarks in their images,
/// the wheel scale and the calibration of the cameras; and what is known of them from before.
struct SmootherWindow {
  std::vector<CameraParameters> cameras;
  std::vector<CameraSettings> camera_settings;
  std::vector<double> camera_noise_scales;  ///< noise found / noise declared
  double wheel_scale = 0;
  std::deque<StateNode> nodes;
  std::deque<WindowView> views;          ///< in order of their first node
  std::map<std::int64_t, Track> tracks;  ///< by number: the order of everything that follows
  LinearPrior prior;

  StateNode& Node(std::int64_t number) {
    return nodes[static_cast<size_t>(number - nodes.front().number)];
  }
  const StateNode& Node(std::int64_t number) const {
    return nodes[static_cast<size_t>(number - nodes.front().number)];
  }
  bool IsEstimated(const StateName& name) const;
  const double* ValuesOf(const StateName& name) const;
  Bearing BearingOf(const FeatureObservation& seen, int camera) const;
  /// Brings the views' geometry to the states as they are.
  void PointViewsAtNodes();
};

/// The states that bearings in `view` depend on, in the order of their blocks.
std::vector<StateName> StatesOf(const WindowView& view);

/// An image on its way into the window.
struct NewImage {
  TrackedFrame frame;
  NodeInterpolation interpolation;  ///< within the interval before the new node
  Eigen::Vector3d angular_velocity =
      Eigen::Vector3d::Zero();  ///< [rad/s] as the gyroscope says, bias included
};

/// A point that left the window.
struct FinishedLandmark {
  std::int64_t node = 0;  ///< the node that left with it: the point moves with that
  Timestamp time;         ///< first seen
  int camera = 0;
  Eigen::Vector3d point_in_odom;  ///< [m]
  double sigma = 0;               ///< [m] along the worst direction
  int num_observations = 0;
};

/// A node that left the window: only SmoothBackwards will correct its state.
struct FinishedNode {
  std::int64_t number = 0;
  MotionState state;
  std::optional<NodeInterval> interval;  ///< since the node before
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< [rotation in imu, position in odom]
  NodeConditionals conditionals;
};

}  // namespace parkade
