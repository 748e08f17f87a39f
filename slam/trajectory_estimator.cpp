#include "slam/trajectory_estimator.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "core/error.h"

namespace parkade {
namespace {

constexpr double kSnap = 0.03;            // [s] a knot moves this far to be at an image
constexpr double kSnapSlack = 0.05;       // [s] of data beyond a knot before it is placed
constexpr double kStillLook = 0.3;        // [s] over which standstill is judged
constexpr double kWheelDoubt = 0.3;       // [s] a car may have moved before its wheels show it
constexpr double kImageDoubt = 0.6;       // [s] or its images
constexpr double kMaxImuGap = 0.5;        // [s] bridged silently
constexpr double kMinData = 1.0;          // [s] of IMU data that can be mapped at all
constexpr double kMaxEarlyFrames = 30.0;  // [s] of images kept to run backwards over the time before the start
constexpr int kFewBearings = 8;           // fewer say next to nothing

bool IsFinite(const ImuSample& sample) {
  return sample.angular_velocity.allFinite() && sample.linear_acceleration.allFinite();
}

int CountCommon(const TrackedFrame& frame) { return static_cast<int>(frame.observations.size()); }

bool SeesTracksOfOthers(const TrackedFrame& frame) {
  return !frame.observations.empty() && (frame.observations.back().track >> 40) != frame.camera;
}

std::string Seconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", seconds);
  return text;
}

}  // namespace

TrajectoryEstimator::TrajectoryEstimator(const Rig& rig, const OdometryOptions& options)
    : rig_(rig),
      options_(options),
      standstill_(rig.imu, rig.cameras.size(), options.standstill),
      smoother_(rig, options.smoother),
      builder_(rig, options.output_interval),
      last_frame_(rig.cameras.size()),
      tracks_seen_(rig.cameras.size(), 0) {
  options_.Validate();
  for (const RigCamera& camera : rig.cameras) report_.cameras.push_back({camera.name, 0, 0, 0, 0, 1});
}

void TrajectoryEstimator::Add(const ImuSample& sample) {
  if (!IsFinite(sample)) return;
  if (imu_.empty()) log_begin_ = sample.time;
  const Timestamp before = imu_.empty() ? sample.time : imu_.back().time;
  if (!imu_.Add(sample)) return;
  if (IsEarly(sample.time)) early_.imu.push_back(sample);
  if (sample.time - before > kMaxImuGap)
    AddDegraded(before, sample.time, "the IMU delivered nothing; bridged by images and wheels");
  Advance();
}

void TrajectoryEstimator::Add(const WheelSample& sample) {
  if (!options_.use_wheels || !std::isfinite(sample.forward_speed)) return;
  if (!wheels_.Add(sample)) return;
  report_.has_wheels = true;
  if (IsEarly(sample.time)) early_.wheels.push_back(sample);
}

void TrajectoryEstimator::Add(TrackedFrame frame) {
  CameraHealth& health = report_.cameras[static_cast<size_t>(frame.camera)];
  ++health.frames;
  Timestamp& last = last_frame_[static_cast<size_t>(frame.camera)];
  if (frame.observations.empty() || (health.frames > 1 && frame.time <= last) ||
      (is_started_ && frame.time <= last_knot_))
    return;
  last = frame.time;
  standstill_.Add(frame);
  if (IsEarly(frame.time)) {
    early_.frames.push_back(frame);
    if (frame.time - early_.frames.front().time > kMaxEarlyFrames) early_.frames.erase(early_.frames.begin());
  }
  pending_.push_back(std::move(frame));
}

std::optional<MotionState> TrajectoryEstimator::Latest() const {
  if (!is_started_) return std::nullopt;
  return smoother_.Latest();
}

void TrajectoryEstimator::Advance() {
  if (!is_started_) TryStart(/*is_last_chance=*/false);
  if (is_started_) PlaceKnots(imu_.back().time - kSnapSlack);
}

Timestamp TrajectoryEstimator::SnapToImage(Timestamp time) const {
  Timestamp best = time;
  double nearest = kSnap;
  for (const TrackedFrame& frame : pending_) {
    if (frame.time > time + kSnap) break;
    const double distance = std::abs(frame.time - time);
    if (frame.time > last_cut_ && distance < nearest) {
      nearest = distance;
      best = frame.time;
    }
  }
  return best;
}

double TrajectoryEstimator::NextInterval() const {
  const KnotOptions& knots = options_.knots;
  const MotionState state = smoother_.Latest();
  const double rate = (imu_.At(last_cut_).angular_velocity - state.gyroscope_bias).norm();
  const double due =
      std::min(knots.distance / std::max(state.velocity_in_odom.norm(), 1e-3), knots.rotation / std::max(rate, 1e-3));
  return std::clamp(due, knots.interval, knots.slow_interval);
}

void TrajectoryEstimator::PlaceKnots(Timestamp until) {
  for (Timestamp cut; (cut = SnapToImage(last_cut_ + options_.knots.interval)) <= until; last_cut_ = cut) {
    const Timestamp look = std::max(imu_.front().time, cut - kStillLook);
    const bool is_still = cut > surely_moving_until_ && standstill_.IsStill(imu_, wheels_, look, cut, is_run_still_);
    const Timestamp surely_still = cut - (report_.has_wheels ? kWheelDoubt : kImageDoubt);
    if (is_run_still_ && !is_still) {
      // The car moved before it was seen to: go back to where it surely stood.
      if (surely_still > last_knot_) MakeKnot(surely_still, true);
      surely_moving_until_ = cut;
      is_run_still_ = false;
      cut = last_knot_;
      continue;
    }
    if (is_still && !is_run_still_ && last_cut_ > last_knot_) MakeKnot(last_cut_, false);
    is_run_still_ = is_still;
    const Timestamp knot = is_still ? surely_still : cut;
    if (knot - last_knot_ > (is_still ? options_.knots.still_interval : NextInterval()) - kSnap)
      MakeKnot(knot, is_still);
  }
}

std::vector<NewImage> TrajectoryEstimator::TakeImages(const ImuPreintegration& imu) {
  // One image per camera and interval: the last, or the last that other cameras' tracks were found in.
  std::vector<TrackedFrame*> chosen(rig_.cameras.size(), nullptr);
  size_t num_taken = 0;
  for (; num_taken < pending_.size() && pending_[num_taken].time <= imu.end(); ++num_taken) {
    TrackedFrame& frame = pending_[num_taken];
    TrackedFrame*& choice = chosen[static_cast<size_t>(frame.camera)];
    if (!choice || SeesTracksOfOthers(frame) || !SeesTracksOfOthers(*choice)) choice = &frame;
  }
  std::vector<NewImage> images;
  const Eigen::Quaterniond odom_from_first = smoother_.Latest().odom_from_imu.rotation;
  for (TrackedFrame* frame : chosen) {
    if (!frame) continue;
    KnotInterpolation interpolation;
    interpolation.fraction = 1;
    if (frame->time < imu.end()) {
      const std::vector<ImuSample> part = imu_.Between(imu.begin(), frame->time);
      interpolation = MakeKnotInterpolation(Integrate(part, imu.bias()), imu.increment(), odom_from_first);
    }
    const auto camera = static_cast<size_t>(frame->camera);
    ++report_.cameras[camera].frames_used;
    tracks_seen_[camera] += CountCommon(*frame);
    used_images_.push_back({frame->time, frame->camera});
    images.push_back({std::move(*frame), interpolation});
  }
  std::sort(images.begin(), images.end(), [](const NewImage& a, const NewImage& b) {
    return std::pair(a.frame.time, a.frame.camera) < std::pair(b.frame.time, b.frame.camera);
  });
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<long>(num_taken));
  return images;
}

void TrajectoryEstimator::MakeKnot(Timestamp time, bool is_still) {
  const MotionState last = smoother_.Latest();
  KnotInterval interval{
      ImuPreintegration(imu_.Between(last_knot_, time), {last.gyroscope_bias, last.accelerometer_bias}, rig_.imu),
      {},
      is_still};
  if (!is_still && wheels_.LongestGap(last_knot_, time) < kMaxWheelGap)
    interval.wheels = PreintegrateWheels(interval.imu.samples(), wheels_.Between(last_knot_, time), last.gyroscope_bias,
                                         rig_.body_from_imu.Inverse(), options_.wheels);
  std::vector<NewImage> images = TakeImages(interval.imu);
  if (is_still) {
    report_.still_seconds += interval.imu.duration();
    images.clear();  // nothing to learn from them but other cars' motion
  }
  int bearings_seen = 0;
  for (const NewImage& image : images) bearings_seen += CountCommon(image.frame);
  if (!is_still) NoteDegradation(last_knot_, time, bearings_seen, interval.wheels.has_value());
  smoother_.AddKnot(std::move(interval), std::move(images));
  last_knot_ = time;
  SolveAndCollect();
  imu_.DropBefore(time - 1.0);
  wheels_.DropBefore(time - 1.0);
}

void TrajectoryEstimator::SolveAndCollect() {
  const SolveSummary solve = smoother_.Solve();
  ++report_.solves;
  sum_solve_seconds_ += solve.seconds;
  report_.max_solve_seconds = std::max(report_.max_solve_seconds, solve.seconds);
  sum_bearings_ += solve.bearings;
  Collect(smoother_.DropOldest());
}

void TrajectoryEstimator::Collect(std::vector<FinishedKnot> finished) {
  report_.knots += static_cast<int>(finished.size());
  std::move(finished.begin(), finished.end(), std::back_inserter(finished_));
  std::vector<FinishedLandmark> landmarks = smoother_.TakeLandmarks();
  std::move(landmarks.begin(), landmarks.end(), std::back_inserter(landmarks_));
}

void TrajectoryEstimator::NoteDegradation(Timestamp begin, Timestamp end, int bearings_seen, bool has_wheels) {
  if (bearings_seen < kFewBearings)
    AddDegraded(begin, end,
                has_wheels ? "no camera sees anything; IMU and wheels carry on"
                           : "no camera sees anything; the IMU alone carries on");
  else if (report_.has_wheels && !has_wheels)
    AddDegraded(begin, end, "the wheels delivered nothing");
}

void TrajectoryEstimator::AddDegraded(Timestamp begin, Timestamp end, const std::string& reason) {
  for (auto it = report_.degraded.rbegin(); it != report_.degraded.rend(); ++it) {
    if (it->reason != reason) continue;
    if (begin - it->end > 0.5) break;
    it->end = std::max(it->end, end);
    return;
  }
  report_.degraded.push_back({begin, end, reason});
}

void TrajectoryEstimator::SelectKeyframes(OdometryResult& result) const {
  std::vector<std::optional<Rigid3>> last(rig_.cameras.size());
  std::vector<UsedImage> images = used_images_;
  std::sort(images.begin(), images.end(), [](const UsedImage& a, const UsedImage& b) {
    return std::pair(a.time, a.camera) < std::pair(b.time, b.camera);
  });
  const double max_rotation = options_.keyframe_rotation_deg * M_PI / 180;
  for (const UsedImage& image : images) {
    const std::optional<Rigid3> pose = result.odom_from_body.At(image.time);
    std::optional<Rigid3>& before = last[static_cast<size_t>(image.camera)];
    if (!pose) continue;
    if (before && (pose->translation - before->translation).norm() < options_.keyframe_distance &&
        pose->rotation.angularDistance(before->rotation) < max_rotation)
      continue;
    before = pose;
    result.keyframes.push_back({image.time, image.camera, *pose});
  }
}

void TrajectoryEstimator::BuildTrajectory(OdometryResult& result) {
  std::map<std::int64_t, Rigid3> corrections;  // smoothed_from_estimated, by knot
  for (const FinishedKnot& knot : finished_) corrections[knot.number] = knot.state.odom_from_imu.Inverse();
  if (options_.smooth_backwards) SmoothBackwards(finished_, smoother_.wheel_scale(), smoother_.LastCovariance());
  for (const FinishedKnot& knot : finished_) {
    corrections[knot.number] = knot.state.odom_from_imu * corrections[knot.number];
    builder_.Add(knot);
    if (!after_start_ && knot.state.time >= first_knot_ + kOverlap) after_start_ = knot.state;
  }
  std::vector<TrajectoryState> states = builder_.Take();
  FillBeforeStart(states);
  result.odom_from_body = Trajectory(std::move(states));
  for (const FinishedLandmark& landmark : landmarks_)
    result.landmarks.push_back({landmark.time, landmark.camera, corrections[landmark.knot] * landmark.point_in_odom,
                                landmark.sigma, landmark.num_observations});
  std::stable_sort(result.landmarks.begin(), result.landmarks.end(),
                   [](const OdometryLandmark& a, const OdometryLandmark& b) { return a.time < b.time; });
}

OdometryResult TrajectoryEstimator::Finish() {
  Require(!imu_.empty(), ErrorCode::kInvalidInput,
          "the log holds no IMU data, without which no trajectory can be estimated");
  const double seconds = imu_.back().time - log_begin_;
  Require(seconds >= kMinData, ErrorCode::kInvalidInput,
          "the log holds only " + Seconds(seconds) + " s of IMU data; at least " + Seconds(kMinData) + " s are needed");
  if (!is_started_) TryStart(/*is_last_chance=*/true);
  Require(is_started_, ErrorCode::kInvalidInput,
          pending_.empty() && wheels_.empty()
              ? "could not initialise because no camera saw anything while the IMU was running and there are no wheels"
              : "could not initialise because the motion in the log never showed speed and gravity clearly enough");
  PlaceKnots(imu_.back().time);
  if (imu_.back().time - last_knot_ > 1e-3) MakeKnot(imu_.back().time, is_run_still_);
  report_.wheel_scale = 1 + smoother_.wheel_scale();
  report_.gyroscope_bias = smoother_.Latest().gyroscope_bias;
  report_.accelerometer_bias = smoother_.Latest().accelerometer_bias;
  for (size_t camera = 0; camera < report_.cameras.size(); ++camera) {
    CameraHealth& health = report_.cameras[camera];
    health.noise_scale = smoother_.camera_noise_scales()[camera];
    if (health.frames_used > 0)
      health.tracks_per_frame = static_cast<double>(tracks_seen_[camera]) / health.frames_used;
  }
  Collect(smoother_.Finish());
  if (report_.solves > 0) {
    report_.mean_solve_seconds = sum_solve_seconds_ / report_.solves;
    report_.mean_bearings = sum_bearings_ / report_.solves;
  }
  OdometryResult result;
  BuildTrajectory(result);
  report_.length = result.odom_from_body.Length();
  SelectKeyframes(result);
  result.report = std::move(report_);
  return result;
}

}  // namespace parkade
