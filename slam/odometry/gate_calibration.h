#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/rig.h"
#include "slam/odometry/odometry_result.h"
#include "slam/smoother/fixed_lag_smoother.h"

namespace parkade {

/// Two covariances of a camera's calibration (8 x 8). Columns: [rotation 3 | translation 3 | time
/// offset | line delay].
struct CalibrationCovariance {
  /// As the weights have it, the inverse information: what share of the estimate is the prior's.
  Eigen::Matrix<double, 8, 8> model;
  /// What its errors really have (LinearPrior::Covariance).
  Eigen::Matrix<double, 8, 8> sandwich;
};

/// The rotation by which the estimate turns all cameras alike, as far as the rig is believed rather
/// than the estimate: cameras that agree with each other cannot be told from an IMU that sits askew
/// or errs about gravity.
struct KeptTurn {
  Eigen::Vector3d angle = Eigen::Vector3d::Zero();  ///< [rad, in imu]
  Eigen::Matrix3d directions =
      Eigen::Matrix3d::Zero();  ///< projects on the directions that are kept, in imu
  std::vector<double> weights;  ///< of the cameras in the mean; sum 1

  /// An estimate without the kept rotation.
  CameraParameters Without(const CameraParameters& estimate) const;
};

/// Directions of the mean turn that are neither sure to 0.075 degrees nor refute the rig by 3 sigma
/// are kept. All cameras' extrinsics must be among the states of `joint`, else nothing is common.
KeptTurn FindKeptTurn(const Rig& rig, const std::vector<CameraParameters>& estimate,
                      const JointEstimate& joint);

/// Covariance of one camera's estimate without the kept rotation. Zero where it was not estimated.
CalibrationCovariance CovarianceWithout(const KeptTurn& turn,
                                        const std::vector<CameraParameters>& estimate,
                                        const JointEstimate& joint, size_t camera);

/// Decides what of a camera's calibration the drive has really measured.
///
/// The marginal covariance of the camera as the weights have it, in units of the
/// prior's sigmas, is decomposed into its principal directions. The rig moves along those
/// directions whose variance, by the model and by the sandwich, is clearly below the prior's; along
/// all others it is kept. A quantity counts as refined where all its sigmas are below what maps
/// need.
struct GatedCalibration {
  CameraParameters parameters;  ///< the rig's, moved along the refined directions
  CameraCalibration report;
};

/// \param rig_parameters  what the rig says
/// \param estimate        what the smoother says, without the kept rotation `turn`
/// \param covariance      the covariance of that estimate
GatedCalibration GateCalibration(const std::string& camera, const CameraSettings& settings,
                                 const CameraParameters& rig_parameters,
                                 const CameraParameters& estimate,
                                 const CalibrationCovariance& covariance,
                                 const KeptTurn& turn = {});

/// The rig by which poses of the IMU become poses of a body on which the cameras sit as `reported`:
/// its IMU is rotated by the median rotation between the cameras as reported and as estimated.
Rig RigOfEstimate(const Rig& reported, const std::vector<CameraParameters>& estimate);

/// [s] how much later images of `camera` are by the rig `to` than by `from`.
double TimeShiftBetween(const Rig& from, const Rig& to, int camera);

}  // namespace parkade
