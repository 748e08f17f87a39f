#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/rig.h"
#include "slam/factors/imu_preintegration.h"
#include "slam/factors/sample_buffer.h"
#include "slam/initialization/gyroscope_bias.h"
#include "slam/tracking/feature_track.h"

namespace parkade {

/// Motion over the first seconds, in the IMU frame at their begin.
struct StartMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s] at the begin
  Eigen::Vector3d gravity = kGravityInOdom;            ///< [m/s^2], of length 9.81
  ImuBias bias;
};

/// One image of the first seconds, and how the IMU carries there from the begin:
/// center = velocity t + gravity t^2/2 + position + rotation * camera_in_imu.
struct StartImage {
  double t = 0;  ///< [s] since the begin
  int camera = 0;
  Eigen::Vector3d camera_in_imu;  ///< [m]
  Eigen::Matrix3d rotation;       ///< at the biases of `linearized_at`, like what follows
  Eigen::Vector3d position;       ///< [m]
  Eigen::Matrix3d rotation_by_gyroscope, position_by_gyroscope, position_by_accelerometer;
  bool is_for_all = true;  ///< false: used for tracks of the ground only
};

/// A track's bearing in one of the images.
struct StartObservation {
  size_t image = 0;
  Eigen::Vector3d bearing;  ///< unit, in the IMU frame at the image
  double sigma = 1e-3;      ///< [rad]
};

/// A track and its point: origin + (ray + across) / inverse_distance, the origin being where it was
/// first seen from.
struct StartTrack {
  std::vector<StartObservation> observations;
  Eigen::Vector3d ray = Eigen::Vector3d::UnitX();  ///< unit, in the IMU frame at the begin
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double inverse_distance = 0;        ///< [1/m]
  double inverse_distance_sigma = 0;  ///< [1/m] for a known motion; after Adjust
};

/// What is known of the scale from elsewhere: the way from begin to end.
struct ScalePrior {
  double way = 0;    ///< [m]
  double sigma = 0;  ///< of its logarithm
};

/// Tracks, images and biases of the first seconds: everything StartFromImages adjusts.
struct StartProblem {
  double duration = 0;  ///< [s]
  std::vector<StartImage> images;
  std::vector<StartTrack> tracks;
  ImuBias linearized_at;
  GyroscopeBiasEstimate gyroscope;        ///< prior
  double accelerometer_bias_sigma = 0.1;  ///< [m/s^2] prior
  StartImage end;                         ///< the last instant, seen from the IMU
  Eigen::Vector3d force =
      Eigen::Vector3d::Zero();  ///< [m/s] integral of what the accelerometer felt, at the begin
  std::optional<ScalePrior> scale;
};

inline constexpr int kStartMotionSize =
    11;  ///< [velocity, gravity's direction (2), gyroscope, accelerometer]

/// Images and tracks between `begin` and `end` (within the IMU's span): some two dozen images of
/// each camera, the tracks that live longest in each, without points yet.
StartProblem CollectStartProblem(const ImuBuffer& imu, const std::vector<TrackedFrame>& frames,
                                 const Rig& rig, const GyroscopeBiasEstimate& bias, Timestamp begin,
                                 Timestamp end);

/// [m/s^2] down, in the IMU frame at the begin, of a car that has `velocity` [m/s] there and keeps
/// it along its own axes.
Eigen::Vector3d SteadyGravity(const StartProblem& problem, const Eigen::Vector3d& velocity);

/// What the ground says about the scale of the points: most of what cameras see below them lies at
/// their own height.
struct GroundScale {
  double log_scale = 0;  ///< by which points and way have to grow
  double sigma = 0;      ///< of that
  int num_points = 0;
};

/// For points that Adjust placed; nothing where the rig does not know the ground or no height
/// stands out.
std::optional<GroundScale> MeasureGroundScale(const StartProblem& problem, const Rig& rig);

}  // namespace parkade
