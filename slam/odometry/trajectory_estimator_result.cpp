// What TrajectoryEstimator hands back at the end.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "slam/odometry/gate_calibration.h"
#include "slam/odometry/trajectory_estimator.h"

namespace parkade {
namespace {

constexpr double kMinData = 1.0;  // [s] of IMU data that can be mapped at all

std::string OneDecimal(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", number);
  return text;
}

}  // namespace

void TrajectoryEstimator::SelectKeyframes(OdometryResult& result) const {
  std::vector<std::optional<Rigid3>> last(rig_.cameras.size());
  std::vector<UsedImage> images = used_images_;
  std::sort(images.begin(), images.end(), [](const UsedImage& a, const UsedImage& b) {
    return std::pair(a.time, a.camera) < std::pair(b.time, b.camera);
  });
  const double max_rotation = options_.keyframe_rotation_deg * M_PI / 180;
  for (const UsedImage& image : images) {
    const Timestamp time = image.time + TimeShiftBetween(rig_, result.rig, image.camera);
    const std::optional<Rigid3> pose = result.odom_from_body.At(time);
    std::optional<Rigid3>& before = last[static_cast<size_t>(image.camera)];
    if (!pose) continue;
    if (before && (pose->translation - before->translation).norm() < options_.keyframe_distance &&
        pose->rotation.angularDistance(before->rotation) < max_rotation)
      continue;
    before = pose;
    result.keyframes.push_back({time, image.camera, *pose});
  }
  std::stable_sort(
      result.keyframes.begin(), result.keyframes.end(),
      [](const OdometryKeyframe& a, const OdometryKeyframe& b) { return a.time < b.time; });
}

void TrajectoryEstimator::BuildTrajectory(OdometryResult& result) {
  std::vector<RecordedNode>& nodes = measurements_->nodes;
  std::vector<Rigid3> corrections;  // smoothed_from_estimated
  for (const RecordedNode& node : nodes) corrections.push_back(node.state.odom_from_imu.Inverse());
  const JointEstimate last = smoother_.LastEstimate();
  FinishCalibration(last, result);
  if (options_.smooth_backwards) SmoothBackwards(nodes, conditionals_, last);
  for (size_t i = 0; i < nodes.size(); ++i) {
    const MotionState& state = nodes[i].state;
    corrections[i] = state.odom_from_imu * corrections[i];
    builder_.Add(nodes[i], measurements_->IntervalBefore(i));
    if (!after_start_ && state.time >= first_node_ + kOverlap) after_start_ = state;
  }
  std::vector<TrajectoryState> states = builder_.Take();
  FillBeforeStart(result.rig, states);
  result.odom_from_body = Trajectory(std::move(states));
  for (const FinishedLandmark& landmark : landmarks_)
    result.landmarks.push_back(
        {landmark.time, landmark.camera,
         corrections[static_cast<size_t>(landmark.node)] * landmark.point_in_odom, landmark.sigma,
         landmark.num_observations});
  std::stable_sort(result.landmarks.begin(), result.landmarks.end(),
                   [](const Landmark& a, const Landmark& b) { return a.time < b.time; });
  TakeMeasurements(result);
}

void TrajectoryEstimator::TakeMeasurements(OdometryResult& result) {
  SharedFindings& shared = measurements_->shared;
  shared.cameras = smoother_.cameras();
  for (const CameraSettings& settings : smoother_.camera_settings()) {
    CameraSigmas& prior = shared.camera_priors.emplace_back(settings.prior);
    if (!settings.has_extrinsics) prior.rotation = prior.translation = 0;
    if (!settings.has_time_offset) prior.time_offset = 0;
    if (!settings.has_line_delay) prior.line_delay = 0;
  }
  shared.camera_noise_scales = smoother_.camera_noise_scales();
  shared.wheel_scale = smoother_.wheel_scale();
  shared.has_jumps = !smoother_.jumps().empty();
  result.measurements = std::move(measurements_);
}

void TrajectoryEstimator::FinishCalibration(const JointEstimate& last, OdometryResult& result) {
  result.rig = rig_;
  const KeptTurn turn = FindKeptTurn(rig_, smoother_.cameras(), last);
  for (size_t i = 0; i < rig_.cameras.size(); ++i) {
    CameraParameters by_rig;
    PoseToParameters(rig_.ImuFromCamera(i), by_rig.extrinsics.data());
    by_rig.timing = {0, rig_.cameras[i].line_delay};
    RigCamera& camera = result.rig.cameras[i];
    GatedCalibration gated = GateCalibration(
        camera.name, smoother_.camera_settings()[i], by_rig, turn.Without(smoother_.cameras()[i]),
        CovarianceWithout(turn, smoother_.cameras(), last, i), turn);
    camera.body_from_camera = rig_.body_from_imu * gated.parameters.ImuFromCamera();
    camera.time_shift += gated.parameters.time_offset();
    camera.line_delay = gated.parameters.line_delay();
    report_.calibration.push_back(std::move(gated.report));
  }
  builder_.MountOn(RigOfEstimate(result.rig, smoother_.cameras()));
}

void TrajectoryEstimator::FinishReport() {
  report_.wheel_scale = 1 + smoother_.wheel_scale();
  report_.gyroscope_bias = smoother_.Latest().gyroscope_bias;
  report_.accelerometer_bias = smoother_.Latest().accelerometer_bias;
  for (size_t camera = 0; camera < report_.cameras.size(); ++camera) {
    CameraHealth& health = report_.cameras[camera];
    health.noise_scale = smoother_.camera_noise_scales()[camera];
    if (health.frames_used > 0)
      health.tracks_per_frame = static_cast<double>(tracks_seen_[camera]) / health.frames_used;
  }
  if (report_.solves > 0) {
    report_.mean_solve_seconds = sum_solve_seconds_ / report_.solves;
    report_.mean_bearings = sum_bearings_ / report_.solves;
  }
}

OdometryResult TrajectoryEstimator::Finish() {
  Require(!imu_.empty(), ErrorCode::kInvalidInput,
          "the log holds no IMU data, without which no trajectory can be estimated");
  const double seconds = imu_.back().time - log_begin_;
  Require(seconds >= kMinData, ErrorCode::kInvalidInput,
          // 0.97 s must not read as 1.0 s, which is enough.
          "the log holds only " + OneDecimal(std::min(seconds, kMinData - 0.1)) +
              " s of IMU data; at least " + OneDecimal(kMinData) + " s are needed");
  if (!is_started_) TryStart(/*is_last_chance=*/true);
  Require(is_started_, ErrorCode::kInvalidInput,
          pending_.empty() && wheels_.empty()
              ? "could not initialize because no camera saw anything while the IMU was running and "
                "there are no wheels"
              : "could not initialize because the motion in the log never showed speed and gravity "
                "clearly enough");
  PlaceNodes(imu_.back().time);
  if (imu_.back().time - last_node_ > 1e-3) MakeNode(imu_.back().time, is_run_still_);
  FinishReport();
  for (const CameraJump& jump : smoother_.jumps())
    AddDegraded(jump.time, jump.time,
                "camera '" + rig_.cameras[static_cast<size_t>(jump.camera)].name +
                    "' was turned by " + OneDecimal(jump.angle * 180 / M_PI) +
                    " deg; calibrated anew from there");
  Collect(smoother_.Finish());
  OdometryResult result;
  BuildTrajectory(result);
  report_.length = result.odom_from_body.Length();
  SelectKeyframes(result);
  result.report = std::move(report_);
  return result;
}

}  // namespace parkade
