#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "slam/factors/imu_preintegration.h"

namespace parkade {

/// How the IMU moved from one node to the next, seen from one instant between:
/// the shape comes from the IMU, what the nodes disagree with it is shared
/// linearly in time. Velocity and constant bias errors are linear or nearly so
/// over a node interval: they cancel, so an image needs the poses of its two
/// nodes only and no state of its own (METHOD 3.5).
///
///   R(t) = R_i dR_t Exp(f e),   e = Log(dR_ij^T R_i^T R_j),   f = (t - t_i) / (t_j - t_i)
///   p(t) = (1 - f) p_i + f p_j + R_i bend
struct NodeInterpolation {
  double fraction = 0;                                                         ///< f in [0, 1]
  Eigen::Quaterniond rotation_since_first = Eigen::Quaterniond::Identity();    ///< dR_t
  Eigen::Quaterniond rotation_over_interval = Eigen::Quaterniond::Identity();  ///< dR_ij
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();  ///< [m] off the chord, in imu at the first node

  /// Pose between `first` and `second`.
  Rigid3 At(const Rigid3& first, const Rigid3& second) const;
};

/// For time `since_first` [s] after the first node, where the IMU has moved by
/// `part`; by `whole` at the second node. `odom_from_first` tells where down is.
NodeInterpolation MakeNodeInterpolation(const MotionIncrement& part, const MotionIncrement& whole,
                                        const Eigen::Quaterniond& odom_from_first);

/// Pose at the time of an image with its derivatives by the nodes' tangents
/// (rotation: right, translation: odom).
struct ImagePose {
  Eigen::Matrix3d odom_from_imu = Eigen::Matrix3d::Identity();
  Eigen::Vector3d imu_in_odom = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Matrix3d rotation_by_first =
      Eigen::Matrix3d::Identity();                               ///< d rotation / d first rotation
  Eigen::Matrix3d rotation_by_second = Eigen::Matrix3d::Zero();  ///< d rotation / d second rotation
  Eigen::Matrix3d position_by_first_rotation = Eigen::Matrix3d::Zero();
  double fraction = 0;  ///< d position / d second position; 1 - fraction for the first
};

ImagePose EvaluateImagePose(const NodeInterpolation& interpolation, const Rigid3& first,
                            const Rigid3& second);

}  // namespace parkade
