#include "slam/feature_tracker.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "core/error.h"
#include "slam/epipolar_check.h"
#include "slam/image_pyramid.h"

namespace parkade {
namespace {

constexpr int kCameraShift = 40;       ///< bits of a track number below the camera index
constexpr int kMaxIterations = 20;     ///< of Lucas-Kanade per level
constexpr double kConvergence = 0.01;  ///< [px]
constexpr double kMovingFlow = 1.0;    ///< [px] median flow of a car that moves

cv::Point2f ToPoint(const Eigen::Vector2d& pixel) {
  return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}

Eigen::Vector2d ToVector(const cv::Point2f& point) { return {point.x, point.y}; }

/// One channel, or empty where the image is not of the calibrated size and type.
cv::Mat ToGray(const cv::Mat& image, const CameraModel& model) {
  if (image.cols != model.width() || image.rows != model.height()) return {};
  if (image.type() == CV_8UC1) return image;
  cv::Mat gray;
  if (image.type() == CV_8UC3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

bool IsSet(const cv::Mat& mask, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
  return x >= 0 && y >= 0 && x < mask.cols && y < mask.rows && mask.at<std::uint8_t>(y, x) != 0;
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void FeatureTrackerOptions::Validate() const {
  Require(max_tracks >= 8 && max_tracks <= 5000, ErrorCode::kUsage, "max_tracks must be in 8..5000");
  Require(window >= 5 && window <= 51 && window % 2 == 1, ErrorCode::kUsage, "window must be odd and in 5..51 px");
  Require(pyramid_levels >= 1 && pyramid_levels <= 8, ErrorCode::kUsage, "pyramid_levels must be in 1..8");
  Require(pixel_sigma > 0, ErrorCode::kUsage, "pixel_sigma must be > 0 px");
  Require(max_round_trip > 0, ErrorCode::kUsage, "max_round_trip must be > 0 px");
  Require(max_epipolar_error > 0, ErrorCode::kUsage, "max_epipolar_error must be > 0 px");
  Require(max_gap > 0, ErrorCode::kUsage, "max_gap must be > 0 s");
}

FeatureTracker::FeatureTracker(const RigCamera& camera, int camera_index, const FeatureTrackerOptions& options)
    : options_((options.Validate(), options)),
      model_(camera.model),
      camera_(camera_index),
      lens_usable_(UsablePixels(camera.model, camera.mask, options.window / 2)),
      usable_(lens_usable_),
      detector_(lens_usable_, options.max_tracks),
      own_body_(camera.model.width(), camera.model.height()),
      next_track_(static_cast<std::int64_t>(camera_index) << kCameraShift) {}

TrackedFrame FeatureTracker::Track(const CameraFrame& frame, const Eigen::Matrix3d& now_from_last_rotation) {
  TrackedFrame result{frame.time, camera_, {}};
  if (!last_.empty() && frame.time <= last_.time) {
    ++statistics_.frames_duplicate;
    return result;
  }
  now_from_last_ = now_from_last_rotation * now_from_last_;
  const cv::Mat gray = ToGray(frame.image, model_);
  if (!IsUsable(gray)) return result;

  ++statistics_.frames_tracked;
  TrackedImage now{frame.time, camera_, model_, {}, usable_, {}};
  now.pyramid = BuildPyramid(NormalizeLocally(gray), options_.window, options_.pyramid_levels);
  const double seconds = last_.empty() ? 0 : frame.time - last_.time;
  if (seconds > options_.max_gap && !last_.observations.empty()) {
    ++statistics_.restarts;
    last_.observations.clear();
  }
  if (last_.observations.empty()) {
    velocities_.clear();
    median_flow_ = 0;
  } else {
    const Flow flow = Follow(now, seconds);
    if (options_.learn_own_body) Learn(flow);
    now.usable = usable_;
    Keep(flow, seconds, now);
  }
  AddCorners(now);
  gray.copyTo(last_gray_);
  last_ = std::move(now);
  now_from_last_.setIdentity();
  result.observations = last_.observations;
  return result;
}

/// Counts why not.
bool FeatureTracker::IsUsable(const cv::Mat& gray) {
  if (gray.empty()) {
    ++statistics_.frames_wrong_size;
    return false;
  }
  if (IsBlank(gray, lens_usable_)) {
    ++statistics_.frames_blank;
    return false;
  }
  // At standstill two equal images are possible (a simulator without noise) and harmless.
  if (median_flow_ > kMovingFlow && cv::norm(gray, last_gray_, cv::NORM_INF) == 0) {
    ++statistics_.frames_duplicate;
    return false;
  }
  return true;
}

FeatureTracker::Flow FeatureTracker::Follow(const TrackedImage& now, double seconds) const {
  const size_t count = last_.observations.size();
  std::vector<cv::Point2f> before(count), predicted(count);
  std::vector<bool> is_predicted(count, false);
  for (size_t i = 0; i < count; ++i) {
    const FeatureObservation& observation = last_.observations[i];
    before[i] = predicted[i] = ToPoint(observation.pixel);
    const Eigen::Vector3d bearing = now_from_last_ * (observation.bearing + seconds * velocities_[i]);
    const std::optional<Eigen::Vector2d> pixel = model_.Project(bearing);
    if (!pixel || !model_.IsInImage(*pixel)) continue;
    predicted[i] = ToPoint(*pixel);
    is_predicted[i] = true;
  }

  const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kMaxIterations, kConvergence);
  const cv::Size window(options_.window, options_.window);
  const int top_level = std::min(options_.pyramid_levels, static_cast<int>(now.pyramid.size() / 2)) - 1;
  Flow flow{predicted, std::vector<bool>(count, false)};
  std::vector<std::uint8_t> is_found, is_found_back;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(last_.pyramid, now.pyramid, before, flow.pixels, is_found, error, window, top_level,
                           criteria, cv::OPTFLOW_USE_INITIAL_FLOW);
  // The way back starts as far off as the prediction was, so that it proves something.
  std::vector<cv::Point2f> back(count);
  for (size_t i = 0; i < count; ++i) back[i] = before[i] + (flow.pixels[i] - predicted[i]);
  cv::calcOpticalFlowPyrLK(now.pyramid, last_.pyramid, flow.pixels, back, is_found_back, error, window, top_level,
                           criteria, cv::OPTFLOW_USE_INITIAL_FLOW);
  for (size_t i = 0; i < count; ++i) {
    flow.is_found[i] = is_predicted[i] && is_found[i] != 0 && is_found_back[i] != 0 &&
                       cv::norm(back[i] - before[i]) < options_.max_round_trip;
  }
  return flow;
}

/// Lets the tracks vote on what is the car's own body.
void FeatureTracker::Learn(const Flow& flow) {
  const int version = own_body_.version();
  for (size_t i = 0; i < flow.pixels.size(); ++i) {
    const FeatureObservation& observation = last_.observations[i];
    const std::optional<Eigen::Vector2d> turned = model_.Project(now_from_last_ * observation.bearing);
    if (flow.is_found[i] && turned) own_body_.Add(observation.pixel, ToVector(flow.pixels[i]), *turned);
  }
  if (own_body_.version() != version) usable_ = own_body_.Exclude(lens_usable_);
}

void FeatureTracker::Keep(const Flow& flow, double seconds, TrackedImage& now) {
  std::vector<FeatureObservation> found;
  std::vector<size_t> origins;  // of found, in last_
  std::vector<BearingPair> pairs;
  for (size_t i = 0; i < flow.pixels.size(); ++i) {
    const Eigen::Vector2d pixel = ToVector(flow.pixels[i]);
    const bool is_on_own_body = flow.is_found[i] && own_body_.IsOwnBody(pixel);
    const auto observation =
        flow.is_found[i] && IsSet(now.usable, pixel) ? Observe(last_.observations[i].track, pixel) : std::nullopt;
    if (!observation) {
      ++(is_on_own_body ? statistics_.lost_on_own_body : statistics_.lost_in_flow);
      continue;
    }
    found.push_back(*observation);
    origins.push_back(i);
    pairs.push_back({last_.observations[i].bearing, observation->bearing, observation->sigma / options_.pixel_sigma});
  }

  const EpipolarCheck check = CheckEpipolarGeometry(pairs, now_from_last_, options_.max_epipolar_error);
  std::vector<double> flows;
  std::vector<Eigen::Vector3d> velocities;
  for (size_t i = 0; i < found.size(); ++i) {
    if (!check.agrees[i]) {
      ++statistics_.lost_in_geometry;
      continue;
    }
    now.observations.push_back(found[i]);
    velocities.push_back((found[i].bearing - check.now_from_last * pairs[i].last) / seconds);
    flows.push_back((found[i].pixel - last_.observations[origins[i]].pixel).norm());
  }
  velocities_ = std::move(velocities);
  median_flow_ = Median(std::move(flows));
}

void FeatureTracker::AddCorners(TrackedImage& now) {
  std::vector<Eigen::Vector2d> present;
  for (const FeatureObservation& observation : now.observations) present.push_back(observation.pixel);
  for (const Eigen::Vector2d& pixel : detector_.Detect(now.pyramid, now.usable, present)) {
    const std::optional<FeatureObservation> observation = Observe(next_track_, pixel);
    if (!observation) continue;
    now.observations.push_back(*observation);
    velocities_.push_back(Eigen::Vector3d::Zero());
    ++next_track_;
    ++statistics_.tracks_started;
  }
}

std::optional<FeatureObservation> FeatureTracker::Observe(std::int64_t track, const Eigen::Vector2d& pixel) const {
  const std::optional<Eigen::Vector3d> bearing = model_.Unproject(pixel);
  const std::optional<double> pixels_per_radian = model_.PixelsPerRadian(pixel);
  if (!bearing || !pixels_per_radian || !(*pixels_per_radian > 0)) return std::nullopt;
  return FeatureObservation{track, pixel, *bearing, options_.pixel_sigma / *pixels_per_radian};
}

}  // namespace parkade
