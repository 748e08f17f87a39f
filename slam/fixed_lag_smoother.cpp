#include "slam/fixed_lag_smoother.h"

#include <algorithm>
#include <cassert>

#include "core/error.h"
#include "slam/triangulate.h"

namespace parkade {
namespace {

// First-order bias correction of a preintegration is trusted this far.
constexpr double kMaxGyroscopeBiasChange = 2e-3;      // [rad/s]
constexpr double kMaxAccelerometerBiasChange = 0.05;  // [m/s^2]
constexpr double kAtKnot = 1e-9;  // an image this near to a knot (fraction of the interval) is at it
constexpr int kMinObservations = 3;
constexpr int kMaxRejections = 2;
constexpr double kStartError = 10;      // [sigma] of rays that may still become a landmark
constexpr double kRebaseTangent = 0.1;  // [a b] beyond which a landmark gets a new ray
constexpr double kNoiseGain = 0.05;     // share of one solve in the estimate of a camera's noise
constexpr double kMinNoiseScale = 0.2, kMaxNoiseScale = 4;
constexpr int kMinErrorsForNoise = 40;
constexpr double kMedianOfChiSquared2 = 1.386;  // of a squared error of two unit-variance residuals

}  // namespace

void SmootherOptions::Validate() const {
  Require(window_knots >= 4 && window_knots <= 100, ErrorCode::kUsage, "'window_knots' must be in 4..100");
  Require(landmarks >= 10 && landmarks <= 2000, ErrorCode::kUsage, "'landmarks' must be in 10..2000");
  Require(max_iterations >= 1 && start_iterations >= 1, ErrorCode::kUsage, "iterations must be positive");
  Require(
      robust_width > 0 && wheel_robust_width > 0 && max_bearing_error > 0 && min_distance > 0 && wheel_scale_sigma > 0,
      ErrorCode::kUsage, "widths, limits and sigmas of the smoother must be positive");
  standstill.Validate();
}

FixedLagSmoother::FixedLagSmoother(const Rig& rig, const SmootherOptions& options)
    : options_(options), camera_noise_scales_(rig.cameras.size(), 1.0) {
  options_.Validate();
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) imu_from_camera_.push_back(rig.ImuFromCamera(camera));
}

void FixedLagSmoother::Start(const MotionState& first, const StartUncertainty& uncertainty,
                             std::vector<NewImage> images) {
  assert(knots_.empty());
  Knot& knot = knots_.emplace_back();
  knot.time = first.time;
  PoseToParameters(first.odom_from_imu, knot.pose.data());
  Eigen::Map<Eigen::Matrix<double, kMotionSize, 1>>(knot.motion.data()) << first.velocity_in_odom, first.gyroscope_bias,
      first.accelerometer_bias;

  constexpr double kExact = 1e-4;  // [rad], [m]: fixes yaw and position, stays well conditioned
  const Eigen::Vector3d up = first.odom_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Matrix3d about_up = up * up.transpose();
  prior_.blocks = {
      {PriorBlock::Kind::kPose, 0, {}}, {PriorBlock::Kind::kMotion, 0, {}}, {PriorBlock::Kind::kWheelScale, -1, {}}};
  std::copy(knot.pose.begin(), knot.pose.end(), prior_.blocks[0].at.begin());
  std::copy(knot.motion.begin(), knot.motion.end(), prior_.blocks[1].at.begin());
  prior_.blocks[2].at[0] = wheel_scale_;
  prior_.sqrt_information = Eigen::MatrixXd::Zero(16, 16);
  prior_.sqrt_information.topLeftCorner<3, 3>() =
      (Eigen::Matrix3d::Identity() - about_up) / uncertainty.tilt + about_up / kExact;
  prior_.sqrt_information.diagonal().segment<3>(3).setConstant(1 / kExact);
  prior_.sqrt_information.diagonal().segment<3>(6).setConstant(1 / uncertainty.velocity);
  prior_.sqrt_information.diagonal().segment<3>(9).setConstant(1 / uncertainty.gyroscope_bias);
  prior_.sqrt_information.diagonal().segment<3>(12).setConstant(1 / uncertainty.accelerometer_bias);
  prior_.sqrt_information(15, 15) = 1 / (options_.estimate_wheel_scale ? options_.wheel_scale_sigma : kExact);
  prior_.offset = Eigen::VectorXd::Zero(16);
  oldest_covariance_.topLeftCorner<3, 3>() = (Eigen::Matrix3d::Identity() - about_up) * std::pow(uncertainty.tilt, 2);
  AddImages(std::move(images), 0, 0);
}

void FixedLagSmoother::AddKnot(KnotInterval interval, std::vector<NewImage> images) {
  assert(!knots_.empty());
  const Knot& last = knots_.back();
  MotionState state = Propagate(last.State(), interval.imu.increment());
  if (interval.is_still) {  // an integrated bias must not make the prediction walk
    state.odom_from_imu = last.State().odom_from_imu;
    state.velocity_in_odom.setZero();
  }
  Knot knot;
  knot.number = last.number + 1;
  knot.time = interval.imu.end();
  PoseToParameters(state.odom_from_imu, knot.pose.data());
  Eigen::Map<Eigen::Matrix<double, kMotionSize, 1>>(knot.motion.data()) << state.velocity_in_odom, state.gyroscope_bias,
      state.accelerometer_bias;
  knot.interval = std::move(interval);
  knots_.push_back(std::move(knot));
  AddImages(std::move(images), knots_.back().number - 1, knots_.back().number);
}

void FixedLagSmoother::AddImages(std::vector<NewImage> images, std::int64_t knot_before, std::int64_t knot_at) {
  for (NewImage& image : images) {
    const bool is_at_knot = knot_before == knot_at || image.interpolation.fraction > 1 - kAtKnot;
    WindowView& view = views_.emplace_back();
    view.time = image.frame.time;
    view.camera = image.frame.camera;
    view.first_knot = is_at_knot ? knot_at : knot_before;
    if (!is_at_knot) view.second_knot = knot_at;
    view.geometry.imu_from_camera = imu_from_camera_[static_cast<size_t>(view.camera)];
    if (!is_at_knot) view.geometry.interpolation = image.interpolation;
    for (const FeatureObservation& seen : image.frame.observations) {
      Track& track = tracks_[seen.track];
      track.last_time = view.time;
      if (track.num_rejections > kMaxRejections) continue;
      if (track.observations.empty() && track.num_consumed == 0) {
        track.number = seen.track;
        track.camera = view.camera;
        track.first_time = view.time;
      }
      const double sigma = seen.sigma * camera_noise_scales_[static_cast<size_t>(view.camera)];
      track.observations.push_back({&view, Bearing(seen.bearing, sigma), nullptr});
    }
  }
  PointViewsAtKnots();
  for (auto& [number, track] : tracks_)
    if (track.has_landmark)
      for (TrackObservation& seen : track.observations)
        if (!seen.cost) seen.cost = std::make_unique<BearingCost>(&seen.view->geometry, &track.ray, seen.bearing);
}

void FixedLagSmoother::PointViewsAtKnots() {
  for (WindowView& view : views_) {
    Knot& first = KnotNumbered(view.first_knot);
    view.geometry.first_pose = first.pose.data();
    view.geometry.first_estimate = &first.first_estimate;
    if (view.second_knot) {
      Knot& second = KnotNumbered(*view.second_knot);
      view.geometry.second_pose = second.pose.data();
      view.geometry.second_estimate = &second.first_estimate;
    }
    view.geometry.Update();
  }
}

bool FixedLagSmoother::StartLandmark(Track& track) {
  std::vector<SightRay> rays;
  for (const TrackObservation& seen : track.observations) {
    const ImageView& view = seen.view->geometry;
    rays.push_back({view.current.imu_in_odom + view.current.odom_from_imu * view.imu_from_camera.translation,
                    view.current.odom_from_imu * (view.imu_from_camera.rotation * seen.bearing.direction),
                    seen.bearing.sigma});
  }
  const std::optional<Triangulated> point = Triangulate(rays, kStartError, options_.min_distance);
  if (!point) return false;
  track.has_landmark = true;
  track.ray = LandmarkRay(rays.front().origin, rays.front().direction);
  track.landmark = {0, 0, point->inverse_distance};
  for (TrackObservation& seen : track.observations)
    seen.cost = std::make_unique<BearingCost>(&seen.view->geometry, &track.ray, seen.bearing);
  return true;
}

void FixedLagSmoother::StartLandmarks() {
  std::vector<const WindowView*> newest(imu_from_camera_.size(), nullptr);
  for (const WindowView& view : views_) newest[static_cast<size_t>(view.camera)] = &view;
  const auto num_seeing = std::count_if(newest.begin(), newest.end(), [](const WindowView* view) { return view; });
  if (num_seeing == 0) return;
  const auto is_seen_now = [&](const Track& track) {
    return !track.observations.empty() &&
           (track.observations.back().view == newest[static_cast<size_t>(track.camera)] ||
            track.observations.back().view->camera != track.camera);
  };
  std::vector<long> budget(newest.size(), options_.landmarks / num_seeing);
  std::vector<Track*> candidates;
  for (auto& [number, track] : tracks_) {
    if (!is_seen_now(track)) continue;
    if (track.has_landmark)
      --budget[static_cast<size_t>(track.camera)];
    else if (track.observations.size() >= kMinObservations)
      candidates.push_back(&track);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Track* a, const Track* b) { return a->observations.size() > b->observations.size(); });
  for (Track* track : candidates) {
    long& left = budget[static_cast<size_t>(track->camera)];
    if (left > 0 && StartLandmark(*track)) --left;
  }
}

SolveSummary FixedLagSmoother::Solve() {
  for (size_t j = 1; j < knots_.size(); ++j) {
    const ImuBias bias = BiasFromParameters(knots_[j - 1].motion.data());
    ImuPreintegration& imu = knots_[j].interval->imu;
    if ((bias.gyroscope - imu.bias().gyroscope).norm() > kMaxGyroscopeBiasChange ||
        (bias.accelerometer - imu.bias().accelerometer).norm() > kMaxAccelerometerBiasChange)
      imu.Reintegrate(bias);
  }
  StartLandmarks();
  const bool is_full = static_cast<int>(knots_.size()) >= options_.window_knots;
  const SolveSummary summary = SolveWindow(has_been_full_ ? options_.max_iterations : options_.start_iterations);
  has_been_full_ = has_been_full_ || is_full;
  RejectOutliers();
  if (options_.scale_camera_noise) UpdateCameraNoise();
  return summary;
}

void FixedLagSmoother::Restart(Track& track) {
  track.has_landmark = false;
  track.observations.clear();
  ++track.num_rejections;
}

bool FixedLagSmoother::RejectOutliersOf(Track& track) {
  if (track.landmark[2] < 0) track.landmark[2] = 0;
  if (track.landmark[2] > 1 / options_.min_distance || !std::isfinite(track.landmark[2])) return false;
  const double limit = options_.max_bearing_error * options_.max_bearing_error;
  std::erase_if(track.observations, [&](const TrackObservation& seen) {
    const Eigen::Vector3d direction = LandmarkInCamera(seen.view->geometry, track.ray, track.landmark.data());
    const Eigen::Vector2d error = seen.bearing.basis.transpose() * direction.normalized() / seen.bearing.sigma;
    return !(direction.dot(seen.bearing.direction) > 0 && error.squaredNorm() < limit);
  });
  if (track.observations.size() < 2) return false;
  const Eigen::Vector3d ray = track.ray.Ray(track.landmark.data());
  if (Eigen::Map<const Eigen::Vector2d>(track.landmark.data()).norm() > kRebaseTangent) {
    track.landmark = {0, 0, track.landmark[2] / ray.norm()};
    track.ray = LandmarkRay(track.ray.origin, ray);
  }
  return true;
}

void FixedLagSmoother::RejectOutliers() {
  for (auto& [number, track] : tracks_)
    if (track.has_landmark && !RejectOutliersOf(track)) Restart(track);
}

void FixedLagSmoother::UpdateCameraNoise() {
  std::vector<std::vector<double>> squared_errors(camera_noise_scales_.size());
  std::vector<double> share(camera_noise_scales_.size(), 0);  // of the errors that landmarks absorbed
  for (const auto& [number, track] : tracks_) {
    if (!track.has_landmark) continue;
    for (const TrackObservation& seen : track.observations) {
      const auto camera = static_cast<size_t>(seen.view->camera);
      const Eigen::Vector3d direction = LandmarkInCamera(seen.view->geometry, track.ray, track.landmark.data());
      const double scaled = 1 / (seen.bearing.sigma / camera_noise_scales_[camera]);
      squared_errors[camera].push_back(
          (scaled * seen.bearing.basis.transpose() * direction.normalized()).squaredNorm());
      share[camera] += 1.5 / static_cast<double>(track.observations.size());
    }
  }
  for (size_t camera = 0; camera < squared_errors.size(); ++camera) {
    std::vector<double>& errors = squared_errors[camera];
    if (errors.size() < kMinErrorsForNoise) continue;
    std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2), errors.end());
    const double freedom = std::max(0.2, 1 - share[camera] / static_cast<double>(errors.size()));
    const double variance = errors[errors.size() / 2] / kMedianOfChiSquared2 / freedom;
    double& scale = camera_noise_scales_[camera];
    scale =
        std::clamp(std::sqrt((1 - kNoiseGain) * scale * scale + kNoiseGain * variance), kMinNoiseScale, kMaxNoiseScale);
  }
}

std::vector<FinishedKnot> FixedLagSmoother::DropOldest() {
  std::vector<FinishedKnot> finished;
  while (static_cast<int>(knots_.size()) > options_.window_knots) finished.push_back(MarginaliseOldest());
  return finished;
}

std::vector<FinishedKnot> FixedLagSmoother::Finish() {
  std::vector<FinishedKnot> finished;
  while (knots_.size() > 1) finished.push_back(MarginaliseOldest());
  if (!knots_.empty()) {
    finished.push_back(
        {knots_.front().number, knots_.front().State(), std::move(knots_.front().interval), oldest_covariance_, {}});
    knots_.clear();
  }
  return finished;
}

std::vector<FinishedLandmark> FixedLagSmoother::TakeLandmarks() { return std::exchange(finished_landmarks_, {}); }

int FixedLagSmoother::NumLandmarks() const {
  return static_cast<int>(
      std::count_if(tracks_.begin(), tracks_.end(), [](const auto& entry) { return entry.second.has_landmark; }));
}

}  // namespace parkade
