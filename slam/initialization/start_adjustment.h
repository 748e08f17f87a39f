#pragma once

#include <Eigen/Core>

#include "slam/initialization/start_problem.h"

namespace parkade {

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
