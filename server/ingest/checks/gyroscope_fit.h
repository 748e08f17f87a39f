#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/rig.h"
#include "server/ingest/checks/gyroscope_history.h"
#include "server/ingest/checks/image_pairs.h"
#include "server/ingest/checks/speed_history.h"

namespace parkade {

/// How the turns that cameras see are those that a gyroscope reads.
struct GyroscopeFit {
  Eigen::Matrix3d true_from_read = Eigen::Matrix3d::Identity();  ///< of rates, in the IMU's axes
  Eigen::Matrix3d sigma = Eigen::Matrix3d::Zero();               ///< of each entry
  double delay = 0, delay_sigma = 0;               ///< [s] by which the IMU's stamps are late
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< [rad/s] read beyond the true rates
  double bias_sigma = 0;                           ///< [rad/s] of its length
  double explained = 0;  ///< share of the points that lie near their planes by the fit
  double turned = 0;     ///< [rad] root of the sum of the squares of what pairs turned
};

/// Fits rotations to what points of image pairs do: least squares of the distances [rad] of points
/// from their epipolar planes, clipped, with a covariance by pairs. Rotations are linear functions
/// of the gyroscope's rates, with a constant rate and a delay. The car's way is that of its wheels,
/// whose scale and sign do not matter, and of a sideways speed that grows with the yaw rate, since
/// bodies do not always lie on the rear axle. Nothing where fewer than ten pairs tell of a turn.
///
/// \param pairs  per camera of the rig; null: not to be used
std::optional<GyroscopeFit> FitGyroscope(const Rig& rig,
                                         const std::vector<const ImagePairs*>& pairs,
                                         const GyroscopeHistory& gyroscope,
                                         const SpeedHistory& wheels);

/// A gain that all axes share: what rates have to be multiplied by.
struct GyroscopeGain {
  double gain = 1, sigma = 0;
};
GyroscopeGain GainOf(const GyroscopeFit& fit);

}  // namespace parkade
