#pragma once

#include <Eigen/Core>

#include "slam/initialization/start_problem.h"

namespace parkade {

/// One observation's residual [sigma] and its derivatives by the point (3) and by the motion.
struct StartResidual {
  Eigen::Vector2d residual = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 3> by_point = Eigen::Matrix<double, 2, 3>::Zero();
  Eigen::Matrix<double, 2, kStartMotionSize> by_motion =
      Eigen::Matrix<double, 2, kStartMotionSize>::Zero();
};

/// An image at one motion.
struct PlacedStartImage {
  Eigen::Vector3d center;
  Eigen::Matrix3d rotation;
  Eigen::Matrix<double, 3, kStartMotionSize> center_by_motion, turn_by_motion;
};

/// [m] where the camera of `image` was.
Eigen::Vector3d CenterOf(const StartImage& image, const StartMotion& motion,
                         const ImuBias& linearized_at);

/// Two directions across `gravity`, as long as it.
Eigen::Matrix<double, 3, 2> GravityBasis(const Eigen::Vector3d& gravity);

/// The image where `motion` carries it, with derivatives by the motion.
PlacedStartImage PlaceStartImage(const StartImage& image, const StartMotion& motion,
                                 const ImuBias& linearized_at);

/// Points behind have a constant error of a right angle, and no derivative.
/// \param across        BasisAcross(track.ray)
/// \param noise         factor on the observations' sigmas
/// \param wants_motion  false: `by_motion` stays zero
StartResidual LinearizeStart(const StartTrack& track, const Eigen::Matrix<double, 3, 2>& across,
                             const StartObservation& observation, const PlacedStartImage& at,
                             double noise, bool wants_motion);

}  // namespace parkade
