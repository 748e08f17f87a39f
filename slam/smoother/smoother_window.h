#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "slam/factors/bearing_cost.h"
#include "slam/factors/imu_preintegration.h"
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
  const WindowView* view = nullptr;
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
