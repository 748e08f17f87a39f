#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/rig.h"
#include "slam/fixed_lag_smoother.h"
#include "slam/odometry_result.h"

namespace parkade {

/// Decides what of a camera's calibration the drive has really measured.
///
/// The marginal covariance of the camera, in units of the prior's sigmas, is
/// decomposed into its principal directions: those along which the estimate is
/// sure to better than half the prior's sigma are refined, along the others the
/// rig is kept. Columns: [rotation 3 | translation 3 | time offset | line delay].
struct GatedCalibration {
  CameraParameters parameters;  ///< the rig's, moved along the refined directions
  CameraCalibration report;
};

/// \param rig_parameters  what the rig says
/// \param estimate        what the smoother says, with `covariance` (8 x 8)
GatedCalibration GateCalibration(const std::string& camera, const CameraSettings& settings,
                                 const CameraParameters& rig_parameters, const CameraParameters& estimate,
                                 const Eigen::Matrix<double, 8, 8>& covariance);

/// [s] by which images of `camera` are later by `to` than by `from`.
double TimeShiftBetween(const Rig& from, const Rig& to, int camera);

}  // namespace parkade
