#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/rig.h"
#include "slam/refinement/adjusted_drive.h"
#include "slam/refinement/adjusted_landmarks.h"
#include "slam/refinement/adjustment_statistics.h"
#include "slam/refinement/drive_graph.h"
#include "slam/refinement/refinement_options.h"

namespace parkade {

/// When a solve ends.
struct SolveLimits {
  int max_steps = 10;
  double least_fall = 1e-5;  ///< share of the cost: the step that changes it by less is the last
};

/// All states of a drive, its landmarks, the wheel scale and the calibration of its cameras as one
/// least-squares problem: the factor graph of FixedLagSmoother without window and marginalization,
/// plus loops and GNSS. Landmarks are eliminated first (Schur), the rest is a band with an arrow.
/// Results do not depend on the number of threads.
class DriveAdjustment {
 public:
  /// \param rig    what the drive's log says: calibration has its prior there
  /// \param start  states of all nodes, from which landmarks are triangulated
  DriveAdjustment(const DriveMeasurements& measurements, const Rig& rig,
                  const std::vector<MotionState>& start, const RefinementOptions& options);

  void SetLoops(std::vector<AdjustedLoop> loops) { drive_.loops = std::move(loops); }

  /// Fixes, and about where odom lies among them.
  void SetGnss(std::vector<AdjustedFix> fixes, const Rigid3& site_from_odom);

  /// Moves the nodes of `stretch`; those outside stay. The first node of the drive keeps position
  /// and yaw. Returns the number of steps.
  int Solve(const AdjustedStretch& stretch, const SolveLimits& limits);

  /// The covariance of the poses of `nodes` around the solution, [rotation in imu, position in
  /// odom] each; position and yaw of the first node of the drive are certain. See
  /// MarginalCovariance.
  std::optional<Eigen::MatrixXd> PoseCovariance(const std::vector<size_t>& nodes);

  /// Moves nodes by one motion of odom each, at their places in time, and triangulates all
  /// landmarks anew.
  void MoveNodes(const std::vector<Rigid3>& odom_from_odom);
  void SetCalibration(const std::vector<CameraParameters>& cameras, double wheel_scale);

  /// Every so many-th landmark pulls nothing and judges the others; 0: all pull.
  void HoldOutLandmarks(size_t every) { parkade::HoldOutLandmarks(every, drive_); }

  /// Moves each landmark to where its bearings meet best from the nodes' current poses.
  void FitLandmarks() { parkade::FitLandmarks(drive_); }

  /// Leaves out bearings that are too far off, and landmarks that too few are left of.
  void RejectOutliers() { parkade::RejectOutliers(drive_); }

  AdjustmentStatistics Statistics() const { return StatisticsOf(drive_); }
  std::vector<MotionState> States() const;
  std::vector<CameraParameters> Cameras() const;
  double WheelScale() const { return *drive_.wheel_scale; }
  const std::vector<AdjustedLoop>& loops() const { return drive_.loops; }
  size_t num_nodes() const { return drive_.nodes.size(); }

 private:
  DriveAdjustment(const DriveMeasurements& measurements, const Rig& rig,
                  const std::vector<MotionState>& start, const RefinementOptions& options,
                  const std::vector<ChosenTrack>& tracks);
  double BearingWeight() const;

  RefinementOptions options_;
  AdjustedDrive drive_;
};

}  // namespace parkade
