#pragma once

#include <ceres/sized_cost_function.h>

#include "slam/factors/node_parameters.h"

namespace parkade {

// Where `odom` lies in the site is one parameter block of 4: [yaw | x y z], both worlds having z
// up.
inline constexpr int kSiteSize = 4;

/// A position of the antenna that was measured between two nodes.
struct AntennaFix {
  double fraction = 0;  ///< of the time from the first to the second node
  Eigen::Vector3d antenna_in_imu = Eigen::Vector3d::Zero();   ///< [m]
  Eigen::Vector3d antenna_in_site = Eigen::Vector3d::Zero();  ///< [m] as measured
  Eigen::Vector3d sigma = Eigen::Vector3d::Constant(1);       ///< [m] east, north, up
};

/// Position of a GNSS antenna (3 values), straight on between the nodes i and j (a car turns by
/// millimeters between):
///
///   r = (R_z(yaw) ((1 - f) (p_i + R_i l) + f (p_j + R_j l)) + t - g) / sigma
///
/// Parameter blocks: pose_i 7, pose_j 7, site_from_odom 4.
class GnssCost final : public ceres::SizedCostFunction<3, kPoseSize, kPoseSize, kSiteSize> {
 public:
  explicit GnssCost(const AntennaFix& fix) : fix_(fix) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  AntennaFix fix_;
};

}  // namespace parkade
