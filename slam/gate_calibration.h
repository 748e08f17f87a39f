#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/rig.h"
#include "slam/fixed_lag_smoother.h"
#include "slam/odometry_result.h"

namespace parkade {

/// Decides what of a camera's calibration the drive has really measured.
///
/// The marginal covariance of the camera as the weights have it, in units of the
/// prior's sigmas, is decomposed into its principal directions. Those along which
/// less than a quarter of the prior's variance is left are observed; those of them
/// along which the estimate is also surer than the rig once it is counted how long
/// errors last are refined. Along all others the rig is kept.
/// Columns: [rotation 3 | translation 3 | time offset | line delay].
struct GatedCalibration {
  CameraParameters parameters;  ///< the rig's, moved along the refined directions
  CameraCalibration report;
};

/// Of a camera's calibration (8 x 8).
struct CalibrationCovariance {
  Eigen::Matrix<double, 8, 8> assumed;  ///< inverse information: what share of the estimate is the prior's
  Eigen::Matrix<double, 8, 8> honest;   ///< of its errors
};

/// \param rig_parameters  what the rig says
/// \param estimate        what the smoother says
GatedCalibration GateCalibration(const std::string& camera, const CameraSettings& settings,
                                 const CameraParameters& rig_parameters, const CameraParameters& estimate,
                                 const CalibrationCovariance& covariance);

/// [s] by which images of `camera` are later by `to` than by `from`.
double TimeShiftBetween(const Rig& from, const Rig& to, int camera);

}  // namespace parkade
