#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/trajectory.h"

namespace parkade {

/// How a drive may still be bent: poses at some times, and the few ways in which they are off
/// together.
///
/// Errors of a refined drive are u_1 m_1 + u_2 m_2 + ..., u normally distributed with variance 1:
/// the principal components of their joint covariance (Karhunen-Loeve). A drive bends slowly, so
/// that a few dozen of them hold nearly all of it, however long it is.
struct CovarianceModes {
  std::vector<Timestamp> times;  ///< ascending
  /// 6 rows per time [rotation vector in odom, rad | position of the body, m], a column per mode:
  /// an error of one sigma.
  Eigen::MatrixXd modes;

  bool empty() const { return times.empty(); }
  Eigen::Index size() const { return modes.cols(); }
  /// 6 x size(): of one pose of the drive, between those of `times`; beyond them as at the nearest.
  Eigen::MatrixXd At(Timestamp time) const;
};

/// \param covariance  of the errors at `times`, 6 x 6 blocks as in CovarianceModes
/// What is left out adds up to less than 1 mm at a pose (rms), rotations counted at 5 m.
CovarianceModes FindCovarianceModes(std::vector<Timestamp> times,
                                    const Eigen::MatrixXd& covariance);

/// The same trajectory with the covariances that its modes have.
Trajectory WithCovariances(const Trajectory& odom_from_body, const CovarianceModes& modes);

/// `pose`, off by [rotation vector in odom | position].
Rigid3 Bent(const Rigid3& pose, const Eigen::Matrix<double, 6, 1>& error);

}  // namespace parkade
