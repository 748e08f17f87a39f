#include "slam/refinement/drive_adjustment.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "core/tune_malloc.h"
#include "slam/refinement/drive_priors.h"
#include "slam/refinement/marginal_covariance.h"

namespace parkade {

DriveAdjustment::DriveAdjustment(const DriveMeasurements& measurements, const Rig& rig,
                                 const std::vector<MotionState>& start,
                                 const RefinementOptions& options)
    : DriveAdjustment(measurements, rig, start, options, ChooseTracks(measurements, options)) {}

DriveAdjustment::DriveAdjustment(const DriveMeasurements& measurements, const Rig& rig,
                                 const std::vector<MotionState>& start,
                                 const RefinementOptions& options,
                                 const std::vector<ChosenTrack>& tracks)
    : options_(options), drive_(measurements, start, tracks.size()) {
  AddDrivePriors(rig, drive_);
  AddLandmarks(measurements, tracks, drive_);
}

// Residuals show the part of a track's errors that it does not share with its neighbors, the
// smaller one.
double DriveAdjustment::BearingWeight() const {
  return 1 / (options_.bearing_inflation * options_.bearing_inflation);
}

int DriveAdjustment::Solve(const AdjustedStretch& stretch, const SolveLimits& limits) {
  ReleaseIdleMemory();  // of the solve before: the factor of this one takes most of all stages
  DriveGraph graph(drive_, stretch, BearingWeight());
  GraphSolverOptions options;
  options.max_iterations = limits.max_steps;
  options.function_tolerance = limits.least_fall;
  options.trust_region = 1e6;  // the pose graph has brought it near
  const SolveSummary summary = graph.graph().Solve(options);
  drive_.PointImages();
  return summary.iterations;
}

std::optional<Eigen::MatrixXd> DriveAdjustment::PoseCovariance(const std::vector<size_t>& nodes) {
  DriveGraph graph(drive_, {0, drive_.nodes.size(), false, true}, BearingWeight());
  std::vector<const double*> poses;
  poses.reserve(nodes.size());
  for (const size_t node : nodes) poses.push_back(drive_.nodes[node].pose);
  const std::vector<double*>& landmarks = graph.graph().landmarks();
  return MarginalCovariance(graph.graph().problem(), {landmarks.begin(), landmarks.end()}, poses);
}

void DriveAdjustment::SetGnss(std::vector<AdjustedFix> fixes, const Rigid3& site_from_odom) {
  drive_.fixes = std::move(fixes);
  const Eigen::Vector3d forward = site_from_odom.rotation * Eigen::Vector3d::UnitX();
  drive_.site_from_odom[0] = std::atan2(forward.y(), forward.x());
  Eigen::Map<Eigen::Vector3d>(drive_.site_from_odom + 1) = site_from_odom.translation;
}

std::vector<MotionState> DriveAdjustment::States() const {
  std::vector<MotionState> states;
  for (const AdjustedNode& node : drive_.nodes)
    states.push_back(StateFromParameters(node.time, node.pose, node.motion));
  return states;
}

std::vector<CameraParameters> DriveAdjustment::Cameras() const {
  std::vector<CameraParameters> cameras;
  for (const CameraBlocks& camera : drive_.cameras) {
    std::copy_n(camera.extrinsics, kPoseSize, cameras.emplace_back().extrinsics.begin());
    std::copy_n(camera.timing, kTimingSize, cameras.back().timing.begin());
  }
  return cameras;
}

void DriveAdjustment::MoveNodes(const std::vector<Rigid3>& odom_from_odom) {
  for (size_t i = 0; i < drive_.nodes.size(); ++i) {
    PoseToParameters(odom_from_odom[i] * PoseFromParameters(drive_.nodes[i].pose),
                     drive_.nodes[i].pose);
    Eigen::Map<Eigen::Vector3d> velocity(drive_.nodes[i].motion);
    velocity = (odom_from_odom[i].rotation * velocity).eval();
  }
  drive_.PointImages();
  TriangulateLandmarks(drive_);
  FitLandmarks();
}

void DriveAdjustment::SetCalibration(const std::vector<CameraParameters>& cameras,
                                     double wheel_scale) {
  for (size_t i = 0; i < drive_.cameras.size(); ++i) {
    std::copy_n(cameras[i].extrinsics.begin(), kPoseSize, drive_.cameras[i].extrinsics);
    std::copy_n(cameras[i].timing.begin(), kTimingSize, drive_.cameras[i].timing);
  }
  *drive_.wheel_scale = wheel_scale;
}

}  // namespace parkade
