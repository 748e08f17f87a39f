#include "tests/bench/odometry/odometry_statistics.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/options_json.h"
#include "core/parallel.h"
#include "slam/evaluation/evaluate_trajectory.h"
#include "slam/odometry/trajectory_estimator.h"

namespace parkade {
namespace {

using simulator::SeenImage;
using simulator::TrackDrive;

constexpr double kFailure = 5;  // [%] of drift
constexpr double kSameTime =
    1e-3;  // [s] within which slam's front end needs no motion to match across cameras

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void MeasureCalibration(const Rig& refined, const TrackDrive& drive, StatisticsRun& run) {
  for (size_t camera = 0; camera < refined.cameras.size(); ++camera) {
    const RigCamera &after = refined.cameras[camera], &truth = drive.true_rig.cameras[camera];
    const Rigid3 off = truth.body_from_camera.Inverse() * after.body_from_camera;
    run.rotation_error_deg =
        std::max(run.rotation_error_deg, LogSo3(off.rotation).norm() * 180 / M_PI);
    run.translation_error_cm = std::max(run.translation_error_cm, 100 * off.translation.norm());
    run.time_offset_error_ms =
        std::max(run.time_offset_error_ms, 1e3 * std::abs(after.time_shift - truth.time_shift));
  }
}

void MeasureAnswer(const OdometryResult& result, const StatisticsCase& question,
                   const TrackDrive& drive, StatisticsRun& run) {
  const TrajectoryEvaluation evaluation =
      EvaluateTrajectory(drive.truth, ToTimedPoses(result.odom_from_body));
  run.drift_percent = 100 * evaluation.rigid.translation.rmse / std::max(1.0, drive.length);
  run.ate = evaluation.rigid.translation.rmse;
  run.consistency = MeasureConsistency(result.odom_from_body, drive.truth, drive.rig.body_from_imu,
                                       {0.25, 0.5, 0.75, 1});
  MeasureCalibration(result.rig, drive, run);
  if (result.report.has_wheels && question.odometry.use_wheels)
    run.wheel_scale_error =
        result.report.wheel_scale * (1 + question.drive.drive.sensors.wheel_scale_error) - 1;
  run.start_kind = result.report.start_kind;
  run.start_seconds = result.report.start_time + result.report.start_data;
  run.coverage = std::min(1.0, result.odom_from_body.span().Seconds() / run.duration);
  for (const CameraHealth& camera : result.report.cameras)
    run.noise_scale = std::max(run.noise_scale, camera.noise_scale);
}

}  // namespace

OdometryResult EstimateTrackDrive(const TrackDrive& drive, const OdometryOptions& options) {
  TrajectoryEstimator estimator(drive.rig, options);
  size_t wheel = 0, image = 0;
  const auto feed_until = [&](Timestamp time) {
    for (; wheel < drive.wheels.size() && drive.wheels[wheel].time <= time; ++wheel)
      estimator.Add(drive.wheels[wheel]);
    for (; image < drive.images.size() && drive.images[image].frame.time <= time; ++image) {
      const SeenImage& seen = drive.images[image];
      TrackedFrame frame = seen.frame;
      if (seen.pair_seconds < kSameTime || estimator.Latest())
        frame.observations.insert(frame.observations.end(), seen.crossed.begin(),
                                  seen.crossed.end());
      estimator.Add(std::move(frame));
    }
  };
  for (const ImuSample& sample : drive.imu) {
    feed_until(sample.time);
    estimator.Add(sample);
  }
  return estimator.Finish();
}

StatisticsRun RunOnce(const StatisticsCase& question, int seed) {
  StatisticsCase asked = question;
  asked.drive.drive.seed = seed;
  if (asked.start != "standing")
    asked.drive.begin = simulator::FindMovingStart(asked.drive, asked.start == "turning");
  const double begin = Now();
  const TrackDrive drive = simulator::MakeTrackDrive(asked.drive, asked.odometry);
  StatisticsRun run;
  run.seed = seed;
  run.length = drive.length;
  run.duration = drive.imu.back().time - drive.imu.front().time;
  const double middle = Now();
  run.making_seconds = middle - begin;
  run.making_ms_per_image = 1e3 * drive.seconds_per_image;
  try {
    const OdometryResult result = EstimateTrackDrive(drive, asked.odometry);
    run.estimating_seconds = Now() - middle;
    MeasureAnswer(result, asked, drive, run);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kUsage) throw;
    run.error = error.what();
  }
  return run;
}

std::vector<StatisticsRun> RunCase(const StatisticsCase& question, int num_runs) {
  return ParallelMap(static_cast<size_t>(num_runs),
                     [&](size_t i) { return RunOnce(question, static_cast<int>(i) + 1); });
}

bool IsFailure(const StatisticsRun& run) {
  return !run.error.empty() || !(run.drift_percent <= kFailure);
}

StatisticsSummary Summarize(const std::vector<StatisticsRun>& runs) {
  StatisticsSummary summary;
  std::vector<double> drifts;
  double estimating = 0, duration = 0;
  const auto answered = static_cast<double>(std::max<std::ptrdiff_t>(
      1, std::count_if(runs.begin(), runs.end(),
                       [](const StatisticsRun& run) { return run.error.empty(); })));
  for (const StatisticsRun& run : runs) {
    summary.num_failures += IsFailure(run);
    if (!run.error.empty()) continue;
    ++summary.num_answers;
    drifts.push_back(run.drift_percent);
    summary.mean_drift += run.drift_percent / answered;
    summary.rotation_error_deg += run.rotation_error_deg / answered;
    summary.translation_error_cm += run.translation_error_cm / answered;
    summary.time_offset_error_ms += run.time_offset_error_ms / answered;
    summary.wheel_scale_error += std::abs(run.wheel_scale_error) / answered;
    summary.start_seconds += run.start_seconds / answered;
    summary.coverage += run.coverage / answered;
    summary.ms_per_image += run.making_ms_per_image / answered;
    estimating += run.estimating_seconds;
    duration += run.duration;
    if (run.consistency.empty()) continue;
    const PoseConsistency& end = run.consistency.back();
    summary.num_consistent += 1;
    summary.nees_pose += end.pose;
    summary.nees_rotation += end.rotation;
    summary.nees_position += end.position;
    for (const PoseConsistency& at : run.consistency)
      summary.nees_on_the_way += at.pose / static_cast<double>(run.consistency.size());
  }
  for (double* nees : {&summary.nees_pose, &summary.nees_rotation, &summary.nees_position,
                       &summary.nees_on_the_way})
    *nees /= std::max(1, summary.num_consistent);
  summary.nees_bounds = BoundsOfMean(summary.num_consistent, 6);
  if (!drifts.empty()) {
    std::sort(drifts.begin(), drifts.end());
    summary.median_drift = 0.5 * (drifts[(drifts.size() - 1) / 2] + drifts[drifts.size() / 2]);
    summary.worst_drift = drifts.back();
  }
  summary.speed_ratio = estimating > 0 ? duration / estimating : 0;
  return summary;
}

std::string TableHead() {
  char line[300];
  std::snprintf(
      line, sizeof line,
      "%-28s %4s | %6s %6s %6s %4s | %6s %6s %6s %6s %-11s | %5s %5s %5s %6s | %5s %5s %6s", "case",
      "runs", "mean%", "med%", "worst%", "fail", "NEES", "rot", "pos", "way", "honest", "deg", "cm",
      "ms", "wheel%", "start", "cover", "speed");
  return line;
}

std::string TableLine(const std::string& name, const std::vector<StatisticsRun>& runs) {
  const StatisticsSummary s = Summarize(runs);
  char line[400];
  std::snprintf(line, sizeof line,
                "%-28s %4zu | %6.3f %6.3f %6.3f %4d | %6.2f %6.2f %6.2f %6.2f [%.2f, %.2f] | %5.2f "
                "%5.2f %5.2f %6.3f | "
                "%5.2f %5.3f %6.2f",
                name.c_str(), runs.size(), s.mean_drift, s.median_drift, s.worst_drift,
                s.num_failures, s.nees_pose, s.nees_rotation, s.nees_position, s.nees_on_the_way,
                s.nees_bounds.low, s.nees_bounds.high, s.rotation_error_deg, s.translation_error_cm,
                s.time_offset_error_ms, 100 * s.wheel_scale_error, s.start_seconds, s.coverage,
                s.speed_ratio);
  return line;
}

}  // namespace parkade
