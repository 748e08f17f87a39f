#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slam/factors/imu_preintegration.h"
#include "slam/initialization/gyroscope_bias.h"

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
  std::optional<ScalePrior> scale;
};

inline constexpr int kStartMotionSize =
    11;  ///< [velocity, gravity's direction (2), gyroscope, accelerometer]
using StartMotionMatrix = Eigen::Matrix<double, kStartMotionSize, kStartMotionSize>;

/// What Adjust found.
struct StartFit {
  StartMotion motion;
  StartMotionMatrix covariance;  ///< as the sigmas of the observations have it, times noise^2;
                                 ///< infinite where singular
  double cost = 0;               ///< robust, at the sigmas times the noise that was given
  double noise = 1;              ///< of the observations, in units of their sigmas
};

/// [m] from begin to end.
Eigen::Vector3d WayOf(const StartProblem& problem, const StartMotion& motion);

/// Points of all tracks for a known motion; returns the robust cost.
double PlacePoints(StartProblem& problem, const StartMotion& motion, double noise);

/// Non-linear least squares of all angles between observations and points (Levenberg-Marquardt,
/// Cauchy loss, points eliminated). Angles, not distances across rays: those are smallest where
/// everything is near and slow.
StartFit Adjust(StartProblem& problem, const StartMotion& from, double noise, int max_iterations);

}  // namespace parkade
