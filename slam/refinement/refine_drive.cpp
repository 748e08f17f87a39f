#include "slam/refinement/refine_drive.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/log.h"
#include "slam/odometry/gate_calibration.h"
#include "slam/odometry/trajectory_builder.h"
#include "slam/refinement/drive_adjustment.h"
#include "slam/refinement/loop_and_gnss_factors.h"
#include "slam/refinement/solve_in_pieces.h"

namespace parkade {
namespace {

constexpr size_t kMinHeldOut = 2;          // loops, fewer judge nothing
constexpr double kOutputInterval = 0.025;  // [s] between states
// Median squared error per degree of freedom of loops that need no excuse. The pose graph shows
// less: it has seen them.
constexpr double kNormalLoopError = 2;
constexpr double kModeDistance = 2;  // [m] between poses that modes speak about
constexpr double kMaxModePoses = 60;
// Least falls of the cost. To reject outliers, and then to judge by what is held out, less will do
// than in the end; steps go on falling slowly for long, as losses are robust.
constexpr double kRoughFall = 1e-2, kJudgedFall = 1e-3, kFinalFall = 1e-5;
constexpr double kNormalImuError =
    1.5;  // mean squared error per degree of freedom that needs no excuse

/// The states of the nodes, moved as the pose graph moved the drive.
std::vector<MotionState> MovedStates(const DriveMeasurements& measurements,
                                     const Trajectory& odometry, const Trajectory& corrected) {
  std::vector<MotionState> states;
  Rigid3 correction;
  for (const RecordedNode& node : measurements.nodes) {
    const std::optional<Rigid3> from = odometry.At(node.state.time),
                                to = corrected.At(node.state.time);
    if (from && to) correction = *to * from->Inverse();
    MotionState& state = states.emplace_back(node.state);
    state.odom_from_imu = correction * state.odom_from_imu;
    state.velocity_in_odom = correction.rotation * state.velocity_in_odom;
  }
  return states;
}

/// The whole drive through the refined nodes; outside of them as it was, moved along.
Trajectory Rebuild(const DriveMeasurements& measurements, const std::vector<MotionState>& states,
                   const Rig& rig, const Trajectory& given) {
  TrajectoryBuilder builder(rig, kOutputInterval);
  for (size_t i = 0; i < states.size(); ++i) {
    const RecordedNode& node = measurements.nodes[i];
    builder.Add({node.number, states[i], node.covariance}, measurements.IntervalBefore(i));
  }
  const std::vector<TrajectoryState> rebuilt = builder.Take();
  const auto moved_like = [&](const TrajectoryState& state) {
    const std::optional<Rigid3> before = given.At(state.time);
    return given.Transformed(before ? state.world_from_body * before->Inverse() : Rigid3{});
  };
  const Trajectory earlier = moved_like(rebuilt.front()), later = moved_like(rebuilt.back());
  std::vector<TrajectoryState> all;
  for (const TrajectoryState& state : earlier.states())
    if (state.time < rebuilt.front().time) all.push_back(state);
  all.insert(all.end(), rebuilt.begin(), rebuilt.end());
  for (const TrajectoryState& state : later.states())
    if (state.time > rebuilt.back().time) all.push_back(state);
  return Trajectory(std::move(all));
}

/// Nodes at even distances along the drive, the first and the last among them.
std::vector<size_t> SpreadNodes(const std::vector<MotionState>& states) {
  std::vector<double> ways(states.size());
  for (size_t i = 1; i < states.size(); ++i)
    ways[i] =
        ways[i - 1] +
        (states[i].odom_from_imu.translation - states[i - 1].odom_from_imu.translation).norm();
  const double distance = std::max(kModeDistance, ways.back() / kMaxModePoses);
  std::vector<size_t> nodes = {0};
  for (size_t i = 1; i + 1 < states.size(); ++i)
    if (ways[i] - ways[nodes.back()] >= distance && ways.back() - ways[i] >= distance)
      nodes.push_back(i);
  nodes.push_back(states.size() - 1);
  return nodes;
}

/// Empty where the drive was solved in pieces, as the whole would take too much memory, or leaves
/// something open.
CovarianceModes ModesOf(DriveAdjustment& adjustment, const Rig& rig, int num_pieces) {
  if (num_pieces > 1) return {};
  const std::vector<MotionState> states = adjustment.States();
  const std::vector<size_t> nodes = SpreadNodes(states);
  const Rigid3 imu_from_body = rig.body_from_imu.Inverse();
  std::vector<Timestamp> times;
  const std::optional<Eigen::MatrixXd> of_imu = adjustment.PoseCovariance(nodes);
  if (!of_imu) return {};
  Eigen::MatrixXd covariance = *of_imu;
  for (size_t i = 0; i < nodes.size(); ++i) {
    const Rigid3& odom_from_imu = states[nodes[i]].odom_from_imu;
    const Eigen::Matrix3d rotation = odom_from_imu.rotation.toRotationMatrix();
    Matrix6d to_body = Matrix6d::Identity();  // from [rotation in imu | position of the imu]
    to_body.topLeftCorner<3, 3>() = rotation;
    to_body.bottomLeftCorner<3, 3>() = -Skew(rotation * imu_from_body.translation) * rotation;
    const auto at = 6 * static_cast<Eigen::Index>(i);
    covariance.middleRows<6>(at) = (to_body * covariance.middleRows<6>(at)).eval();
    covariance.middleCols<6>(at) = (covariance.middleCols<6>(at) * to_body.transpose()).eval();
    times.push_back(states[nodes[i]].time);
  }
  return FindCovarianceModes(std::move(times), covariance);
}

/// Takes the refined value of what odometry had found observable.
void TakeCalibration(const OdometryResult& odometry, const std::vector<CameraParameters>& refined,
                     DriveRefinement& result) {
  const auto is_refined = [&](size_t camera, const char* name) {
    for (const CalibratedQuantity& quantity : odometry.report.calibration[camera].quantities)
      if (quantity.name == name) return quantity.status == CalibratedQuantity::Status::kRefined;
    return false;
  };
  for (size_t i = 0; i < refined.size() && i < odometry.report.calibration.size(); ++i) {
    const CameraParameters& before = odometry.measurements->shared.cameras[i];
    const Rigid3 now = refined[i].ImuFromCamera(), then = before.ImuFromCamera();
    CameraRefinement& camera = result.cameras.emplace_back();
    camera.name = odometry.rig.cameras[i].name;
    camera.rotation = then.rotation.angularDistance(now.rotation);
    camera.translation = (now.translation - then.translation).norm();
    camera.time_offset = refined[i].time_offset() - before.time_offset();
    Rigid3 imu_from_camera = result.rig.ImuFromCamera(i);
    const bool takes_rotation = is_refined(i, "rotation"),
               takes_translation = is_refined(i, "translation");
    if (takes_rotation) imu_from_camera.rotation = now.rotation;
    if (takes_translation) imu_from_camera.translation = now.translation;
    camera.is_taken = takes_rotation || takes_translation;
    result.rig.cameras[i].body_from_camera = result.rig.body_from_imu * imu_from_camera;
  }
}

std::string ReasonAgainst(const DriveRefinement& result, const RefinementOptions& options) {
  const AdjustmentStatistics &before = result.before, &after = result.after;
  if (!std::isfinite(after.imu + after.bearings + after.unused_bearings + after.loops))
    return "no finite solution";
  if (after.num_landmarks == 0) return "no point was seen often enough";
  if (after.unused_bearings > options.max_track_growth * before.unused_bearings)
    return "held-out tracks got worse";
  if (result.num_held_out > 0 &&
      after.unused_loops >
          std::max(kNormalLoopError, options.max_held_out_growth * before.unused_loops))
    return "held-out loops got worse";
  if (after.imu > std::max(kNormalImuError, options.max_imu_growth * before.imu))
    return "the IMU disagrees";
  return "";
}

}  // namespace

GnssPositions ReadGnss(const DriveLog& log, const GnssAlignOptions& options) {
  GnssPositions gnss;
  gnss.options = options;
  const std::optional<VehicleCalibration>& vehicle = log.rig().vehicle;
  if (vehicle && vehicle->antenna_in_body) gnss.antenna_in_body = *vehicle->antenna_in_body;
  ReadOptions only_gnss;
  only_gnss.imu = only_gnss.wheels = only_gnss.images = false;
  const std::unique_ptr<RecordStream> records = log.Read(only_gnss);
  while (const std::optional<SensorRecord> record = records->Next())
    if (const auto* fix = std::get_if<GnssFix>(&*record)) gnss.fixes.push_back(*fix);
  return gnss;
}

DriveRefinement RefineDrive(const OdometryResult& odometry, const Rig& rig,
                            const LoopClosure& closure, const RefinementOptions& options,
                            const GnssPositions& gnss) {
  options.Validate();
  const auto start = std::chrono::steady_clock::now();
  DriveRefinement result;
  result.odom_from_body = closure.odom_from_body;
  result.rig = odometry.rig;
  const auto refuse = [&](const std::string& reason) {
    result.reason = reason;
    return result;
  };
  if (!options.enabled) return refuse("switched off");
  if (!odometry.measurements) return refuse("nothing was measured");
  const DriveMeasurements& measurements = *odometry.measurements;
  if (measurements.nodes.size() < static_cast<size_t>(options.min_nodes))
    return refuse("the drive is too short");
  if (measurements.shared.has_jumps) return refuse("a camera's mount turned during the drive");

  std::vector<AdjustedLoop> loops =
      LoopsBetweenNodes(measurements, odometry.odom_from_body, closure);
  result.num_loops = static_cast<int>(loops.size());
  const auto every =
      options.held_out_share > 0 ? static_cast<size_t>(std::lround(1 / options.held_out_share)) : 0;
  if (every > 0 && loops.size() >= kMinHeldOut * every)
    for (size_t i = every / 2; i < loops.size(); i += every) {
      loops[i].is_used = false;
      ++result.num_held_out;
    }

  DriveAdjustment adjustment(
      measurements, rig, MovedStates(measurements, odometry.odom_from_body, closure.odom_from_body),
      options);
  result.num_nodes = adjustment.num_nodes();
  adjustment.SetLoops(loops);
  const PlacedFixes placed = FixesBetweenNodes(measurements, rig, closure.odom_from_body, gnss);
  result.num_fixes = static_cast<int>(placed.fixes.size());
  adjustment.SetGnss(placed.fixes, placed.site_from_odom);
  adjustment.HoldOutLandmarks(every);
  PieceOptions pieces{static_cast<size_t>(options.max_nodes),
                      static_cast<size_t>(options.piece_nodes),
                      {options.max_iterations}};
  result.num_pieces = NumPieces(adjustment.num_nodes(), pieces);
  const auto solve = [&](double least_fall) {
    pieces.limits.least_fall = least_fall;
    result.num_iterations += SolveInPieces(adjustment, pieces);
  };
  adjustment.FitLandmarks();
  result.before = adjustment.Statistics();
  solve(kRoughFall);
  adjustment.RejectOutliers();
  solve(kJudgedFall);
  adjustment.FitLandmarks();
  result.after = adjustment.Statistics();
  result.reason = ReasonAgainst(result, options);
  if (result.reason.empty()) {
    for (AdjustedLoop& loop : loops) loop.is_used = true;
    adjustment.SetLoops(loops);
    adjustment.HoldOutLandmarks(0);
    adjustment.RejectOutliers();
    solve(kFinalFall);
    result.is_accepted = true;
    TakeCalibration(odometry, adjustment.Cameras(), result);
    result.modes = ModesOf(adjustment, rig, result.num_pieces);
    result.odom_from_body =
        Rebuild(measurements, adjustment.States(), RigOfEstimate(result.rig, adjustment.Cameras()),
                closure.odom_from_body);
    if (!result.modes.empty())
      result.odom_from_body = WithCovariances(result.odom_from_body, result.modes);
    result.wheel_scale = 1 + adjustment.WheelScale();
    for (const TrajectoryState& state : result.odom_from_body.states())
      if (const std::optional<Rigid3> given = closure.odom_from_body.At(state.time))
        result.largest_correction =
            std::max(result.largest_correction,
                     (given->translation - state.world_from_body.translation).norm());
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  LogInfo("stage=refinement accepted=" + std::to_string(result.is_accepted) + " bearings=" +
          std::to_string(result.after.num_bearings) + " seconds=" + std::to_string(result.seconds));
  return result;
}

}  // namespace parkade
