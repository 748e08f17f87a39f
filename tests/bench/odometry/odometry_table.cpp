#include "tests/bench/odometry/odometry_table.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "core/error.h"
#include "slam/evaluation/evaluate_trajectory.h"
#include "slam/odometry/estimate_trajectory.h"
#include "tests/bench/suite/rerigged_log.h"
#include "tests/simulator/faults/faulty_rig.h"

namespace parkade {
namespace {

constexpr double kFailure = 5;                      // [%] of drift
constexpr double kCentimetersPerDegree = 10.0 / 3;  // 0.3 degrees and 1 cm, as the goals have it
constexpr double kStampErrors[] = {0.03, -0.03, 0.02, -0.01};  // [s] per camera

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Begins a new maximum of what PeakMemory tells (Linux).
void ResetPeakMemory() { std::ofstream("/proc/self/clear_refs") << "5"; }

/// [MB] of this process, resident, since ResetPeakMemory.
double PeakMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) * 1024 / 1e6;
  return 0;
}

std::uint64_t SeedOf(const std::string& name) {
  std::uint64_t seed = 1469598103934665603u;  // FNV-1a: the same on every machine
  for (const char letter : name)
    seed = (seed ^ static_cast<unsigned char>(letter)) * 1099511628211u;
  return seed;
}

bool IsReleased(const OdometryReport& report, size_t camera, const std::string& quantity) {
  if (camera >= report.calibration.size()) return false;
  return std::any_of(report.calibration[camera].quantities.begin(),
                     report.calibration[camera].quantities.end(), [&](const CalibratedQuantity& q) {
                       return q.name == quantity &&
                              q.status == CalibratedQuantity::Status::kRefined;
                     });
}

void MeasureCalibration(const OdometryResult& result, const Rig& truth, TableRun& run) {
  for (size_t camera = 0; camera < result.rig.cameras.size(); ++camera) {
    const RigCamera& after = result.rig.cameras[camera];
    const auto& true_camera =
        *std::find_if(truth.cameras.begin(), truth.cameras.end(),
                      [&](const RigCamera& candidate) { return candidate.name == after.name; });
    const Rigid3 off = true_camera.body_from_camera.Inverse() * after.body_from_camera;
    const double degrees = LogSo3(off.rotation).norm() * 180 / M_PI,
                 millimeters = 1e3 * off.translation.norm();
    run.rotation_deg = std::max(run.rotation_deg, degrees);
    run.translation_mm = std::max(run.translation_mm, millimeters);
    if (IsReleased(result.report, camera, "rotation")) {
      run.released_deg = std::max(run.released_deg, degrees);
      ++run.num_released;
    }
    if (IsReleased(result.report, camera, "translation")) {
      run.released_mm = std::max(run.released_mm, millimeters);
      ++run.num_released;
    }
    run.time_offset_ms =
        std::max(run.time_offset_ms, 1e3 * std::abs(after.time_shift - true_camera.time_shift));
  }
}

void MeasureAnswer(const OdometryResult& result, const SuiteDrive& drive, TableRun& run) {
  const std::vector<TimedPose> odom_from_imu =
      PosesOf(ToTimedPoses(result.odom_from_body), result.rig.body_from_imu);
  const TrajectoryEvaluation evaluation = EvaluateTrajectory(drive.world_from_imu, odom_from_imu);
  run.length = evaluation.path_length;
  run.ate = evaluation.rigid.translation.rmse;
  run.drift_percent = evaluation.drift_percent;
  run.coverage = std::min(1.0, result.odom_from_body.span().Seconds() / run.duration);
  for (const TimedPose& pose : odom_from_imu) {
    run.world_from_imu.push_back(pose);
    run.world_from_imu.back().world_from_frame =
        evaluation.rigid.truth_from_estimate * pose.world_from_frame;
  }
  MeasureCalibration(result, drive.true_rig_at_end, run);
  run.start_kind = result.report.start_kind;
  run.start_seconds = result.report.start_time + result.report.start_data;
  for (const CameraHealth& camera : result.report.cameras)
    run.noise_scales.push_back(camera.noise_scale);
  for (const DegradedInterval& interval : result.report.degraded) {
    char line[80];
    std::snprintf(line, sizeof line, "%.1f-%.1f s: ", interval.begin - drive.log->span().begin,
                  interval.end - drive.log->span().begin);
    run.degraded.push_back(line + interval.reason);
  }
}

}  // namespace

TableVariant ParseVariant(const std::string& name) {
  const auto complain = [&] {
    throw Error(ErrorCode::kUsage, "'" + name + "' is no variant: CAMERAS[-wheels]-RIG");
  };
  TableVariant variant;
  variant.name = name;
  const size_t first = name.find('-'), last = name.rfind('-');
  if (first == std::string::npos || last + 1 == name.size()) complain();
  const std::string cameras = name.substr(0, first);
  if (cameras != "four") variant.camera = cameras;
  if (last != first && name.substr(first, last - first) != "-wheels") complain();
  variant.has_wheels = last != first;
  variant.rig = name.substr(last + 1);
  if (variant.rig == "exact" || variant.rig == "nominal" || variant.rig == "stamps") return variant;
  if (variant.rig.find_first_not_of("0123456789.") != std::string::npos) complain();
  variant.rotation_deg = std::stod(variant.rig);
  variant.translation_cm = kCentimetersPerDegree * variant.rotation_deg;
  if (variant.rotation_deg == 1) variant.translation_cm = 3;
  return variant;
}

std::vector<std::string> StandardVariants() {
  return {"four-exact",    "four-0.3",    "four-1",     "four-wheels-0.3", "four-wheels-exact",
          "four-wheels-1", "four-stamps", "cam0-exact", "cam1-exact",      "cam2-exact",
          "cam3-exact",    "cam0-1",      "cam1-1",     "cam2-1",          "cam3-1",
          "four-nominal"};
}

Rig RigOfVariant(const TableVariant& variant, const SuiteDrive& drive) {
  if (variant.rig == "exact") return drive.true_rig;
  if (variant.rig == "nominal") return drive.nominal_rig;
  if (variant.rig == "stamps") {
    Rig rig = drive.true_rig;
    for (size_t camera = 0; camera < rig.cameras.size(); ++camera)
      rig.cameras[camera].time_shift += kStampErrors[camera % std::size(kStampErrors)];
    return rig;
  }
  simulator::FaultOptions faults;
  faults.extrinsic_rotation_deg = {variant.rotation_deg};
  faults.extrinsic_translation_cm = {variant.translation_cm};
  return simulator::NominalRig(drive.true_rig, faults, SeedOf(drive.name));
}

bool IsFailure(const TableRun& run) {
  return !run.error.empty() || !(run.drift_percent <= kFailure);
}

TableRun RunVariant(const SuiteDrive& drive, const TableVariant& variant,
                    const OdometryOptions& options) {
  std::vector<int> cameras;
  for (size_t camera = 0; camera < drive.true_rig.cameras.size(); ++camera)
    if (variant.camera == drive.true_rig.cameras[camera].name)
      cameras.push_back(static_cast<int>(camera));
  Require(variant.camera.empty() || !cameras.empty(), ErrorCode::kUsage,
          "no camera is called " + variant.camera);
  const ReriggedLog log(*drive.log, RigOfVariant(variant, drive), cameras);
  OdometryOptions odometry = options;
  odometry.use_wheels = variant.has_wheels;
  TableRun run;
  run.drive = drive.name;
  run.scene = drive.scene;
  run.variant = variant.name;
  run.duration = drive.log->span().Seconds();
  ResetPeakMemory();
  const double begin = Now();
  try {
    const OdometryResult result = EstimateTrajectory(log, odometry);
    run.wall_seconds = Now() - begin;
    run.peak_memory_mb = PeakMemory();
    MeasureAnswer(result, drive, run);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kUsage) throw;
    run.wall_seconds = Now() - begin;
    run.error = error.what();
  }
  return run;
}

}  // namespace parkade
