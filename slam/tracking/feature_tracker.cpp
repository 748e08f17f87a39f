#include "slam/tracking/feature_tracker.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "core/math/statistics.h"
#include "slam/tracking/image_pyramid.h"
#include "slam/tracking/lucas_kanade.h"
#include "slam/tracking/non_maximum_suppression.h"
#include "slam/tracking/parallax_field.h"

namespace parkade {
namespace {

constexpr int kCameraShift = 40;     ///< bits of a track number below the camera index
constexpr double kOtherStart = 1.5;  ///< [px] from a start that failed: nearer ones would fail, too
constexpr double kMinSimilarity =
    0.8;  ///< correlation with the reference patch of a track that is believed
constexpr double kMaxCreep =
    1.5;  ///< [px] between where optical flow and where the reference patch puts a track
constexpr double kMaxSurprise =
    2.0;  ///< [px] between where the last step leads and where the reference patch puts a track
constexpr double kMaxGrowth = 2.5;   ///< of a patch's area before it gets a new reference
constexpr double kMovingFlow = 1.0;  ///< [px] median flow of a car that moves

bool IsSet(const cv::Mat& mask, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::lround(pixel.x())),
            y = static_cast<int>(std::lround(pixel.y()));
  return x >= 0 && y >= 0 && x < mask.cols && y < mask.rows && mask.at<std::uint8_t>(y, x) != 0;
}

/// Says whether two images of one size are equal; most differ in their first row.
bool AreEqual(const cv::Mat& a, const cv::Mat& b) {
  for (int y = 0; y < a.rows; ++y)
    if (!std::equal(a.ptr(y), a.ptr(y) + a.cols, b.ptr(y))) return false;
  return true;
}

}  // namespace

FeatureTracker::FeatureTracker(const RigCamera& camera, int camera_index,
                               const FeatureTrackerOptions& options)
    : options_((options.Validate(), options)),
      model_(camera.model),
      up_in_camera_(camera.body_from_camera.rotation.conjugate() * Eigen::Vector3d::UnitZ()),
      camera_(camera_index),
      lens_usable_(UsablePixels(camera.model, camera.mask, options.window / 2)),
      usable_(lens_usable_),
      detector_(lens_usable_, options.max_tracks),
      ego_mask_(camera.model.width(), camera.model.height()),
      barren_(camera.model.width(), camera.model.height(), 2 * detector_.cell_size()),
      next_track_(static_cast<std::int64_t>(camera_index) << kCameraShift) {}

TrackedFrame FeatureTracker::Track(const CameraFrame& frame,
                                   const Eigen::Matrix3d& now_from_last_rotation) {
  TrackedFrame result{frame.time, camera_, {}};
  if (!last_.empty() && frame.time <= last_.time) {
    ++statistics_.frames_duplicate;
    return result;
  }
  now_from_last_ = now_from_last_rotation * now_from_last_;
  const cv::Mat gray = ToGray(frame.image, {model_.width(), model_.height()});
  if (!IsUsable(gray)) return result;

  ++statistics_.frames_tracked;
  TrackedImage now{frame.time, camera_, model_, up_in_camera_, {}, usable_, {}};
  now.pyramid = BuildPyramid(NormalizeLocally(gray), options_.pyramid_levels);
  const double seconds = last_.empty() ? 0 : frame.time - last_.time;
  if (seconds > options_.max_gap && !last_.observations.empty()) {
    ++statistics_.restarts;
    last_.observations.clear();
  }
  median_flow_ = 0;
  if (!last_.observations.empty()) {
    const std::vector<std::optional<Eigen::Vector2d>> predicted = Predict(seconds);
    std::vector<Found> found = Follow(now, predicted);
    statistics_.lost_in_flow += std::ssize(last_.observations) - std::ssize(found);
    std::vector<BearingPair> pairs;
    pairs.reserve(found.size());
    for (const Found& track : found) pairs.push_back(track.pair);
    const EpipolarCheck check =
        CheckEpipolarGeometry(pairs, now_from_last_, options_.max_epipolar_error);
    if (options_.learn_own_body && check.is_trusted) LearnEgoMask(found, check);
    now.usable = usable_;
    Keep(std::move(found), predicted, check, now);
  } else {
    memories_.clear();
  }
  last_seconds_ = seconds;
  AddCorners(now);
  gray.copyTo(last_gray_);
  last_ = std::move(now);
  now_from_last_.setIdentity();
  result.observations = last_.observations;
  return result;
}

/// Counts why a frame is refused.
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
  if (median_flow_ > kMovingFlow && AreEqual(gray, last_gray_)) {
    ++statistics_.frames_duplicate;
    return false;
  }
  return true;
}

/// Where each track of last_ should be now: turned as the gyro says, and moved as
/// if the last step went on.
std::vector<std::optional<Eigen::Vector2d>> FeatureTracker::Predict(double seconds) const {
  ParallaxField field;
  for (size_t i = 0; i < memories_.size(); ++i)
    if (memories_[i].parallax) field.Add(last_.observations[i].bearing, *memories_[i].parallax);
  const double steps = last_seconds_ > 0 ? seconds / last_seconds_ : 0;
  std::vector<std::optional<Eigen::Vector2d>> predicted;
  for (size_t i = 0; i < last_.observations.size(); ++i) {
    const Eigen::Vector3d& bearing = last_.observations[i].bearing;
    const double parallax =
        memories_[i].parallax ? *memories_[i].parallax : field.At(bearing).value_or(0);
    predicted.push_back(model_.Project(now_from_last_ * (bearing + steps * parallax * direction_)));
  }
  return predicted;
}

/// Finds tracks near the predicted pixels; those without one are left out. What still looks like
/// its reference where the last step leads needs no Lucas-Kanade, there and back again.
std::vector<FeatureTracker::Found> FeatureTracker::Follow(
    const TrackedImage& now, std::vector<std::optional<Eigen::Vector2d>> predicted) const {
  const cv::Mat& image = now.pyramid[0];
  std::vector<std::optional<Found>> recognized(predicted.size());
  std::vector<Eigen::Vector2d> before;
  for (size_t i = 0; i < predicted.size(); ++i) {
    before.push_back(last_.observations[i].pixel);
    if (predicted[i] && !model_.IsInImage(*predicted[i])) predicted[i].reset();
    if (!predicted[i] || !memories_[i].parallax) continue;
    Found track = Refine(image, i, *predicted[i], kMaxSurprise);
    if (!track.image_from_reference || !IsSet(lens_usable_, track.observation.pixel)) continue;
    recognized[i] = std::move(track);
    predicted[i].reset();
  }
  const auto after =
      FollowThereAndBack(last_.pyramid, now.pyramid, before, predicted,
                         {.window = options_.window, .max_round_trip = options_.max_round_trip});
  std::vector<Found> found;
  for (size_t i = 0; i < after.size(); ++i) {
    if (!recognized[i] && (!after[i] || !IsSet(lens_usable_, *after[i]))) continue;
    Found track = recognized[i] ? *recognized[i] : Refine(image, i, *after[i], kMaxCreep);
    const FeatureObservation& last = last_.observations[i];
    const std::optional<FeatureObservation> observation =
        Observe(last.track, track.observation.pixel);
    if (!observation) continue;
    track.observation = *observation;
    track.pair = {last.bearing, observation->bearing, observation->sigma / options_.pixel_sigma};
    found.push_back(std::move(track));
  }
  return found;
}

/// The pixel that agrees with the track's reference patch, where it still looks like that and lies
/// within `max_shift` [px].
FeatureTracker::Found FeatureTracker::Refine(const cv::Mat& image, size_t origin,
                                             const Eigen::Vector2d& pixel, double max_shift) const {
  Found track;
  track.origin = origin;
  track.observation.pixel = pixel;
  const Memory& memory = memories_[origin];
  if (!memory.reference) return track;
  const auto aligned = memory.reference->AlignIn(image, pixel, memory.image_from_reference);
  if (!aligned || aligned->correlation < kMinSimilarity ||
      (aligned->pixel - pixel).norm() > max_shift)
    return track;
  track.observation.pixel = aligned->pixel;
  track.image_from_reference = aligned->image_from_reference;
  return track;
}

/// The reference patch from now on: the first one, until the point is seen from too far away or too
/// near.
FeatureTracker::Memory FeatureTracker::Remember(Memory memory, const Found& track,
                                                const cv::Mat& image) {
  const double area = track.image_from_reference ? track.image_from_reference->determinant() : 0;
  if (area > 1 / kMaxGrowth && area < kMaxGrowth) {
    memory.image_from_reference = *track.image_from_reference;
  } else {
    memory.reference = ReferencePatch::Take(image, track.observation.pixel);
    memory.image_from_reference.setIdentity();
  }
  return memory;
}

/// Lets the tracks vote on what is the car's own body. The rotation is that of the images: to a
/// biased gyro a parked car seems to turn.
void FeatureTracker::LearnEgoMask(const std::vector<Found>& found, const EpipolarCheck& check) {
  const int version = ego_mask_.version();
  for (const Found& track : found) {
    const std::optional<Eigen::Vector2d> turned =
        model_.Project(check.now_from_last * track.pair.last);
    if (turned)
      ego_mask_.Add(last_.observations[track.origin].pixel, track.observation.pixel, *turned);
  }
  if (ego_mask_.version() != version) usable_ = ego_mask_.Exclude(lens_usable_);
}

/// Looks again for what was not found, from where its neighbors' parallax puts
/// it: near ground moves far between two images of a fast car.
std::vector<FeatureTracker::Found> FeatureTracker::Retry(
    const TrackedImage& now, const std::vector<Found>& found,
    const std::vector<std::optional<Eigen::Vector2d>>& tried, const EpipolarCheck& check) const {
  ParallaxField field;
  std::vector<bool> is_missing(last_.observations.size(), true);
  for (const Found& track : found) {
    const Eigen::Vector3d turned = check.now_from_last * track.pair.last;
    field.Add(turned, ParallaxOf(turned, track.pair.now, check.direction));
    is_missing[track.origin] = false;
  }
  std::vector<std::optional<Eigen::Vector2d>> predicted(last_.observations.size());
  for (size_t i = 0; i < predicted.size(); ++i) {
    if (!is_missing[i]) continue;
    const Eigen::Vector3d turned = check.now_from_last * last_.observations[i].bearing;
    const std::optional<double> parallax = field.At(turned);
    if (!parallax) continue;
    const std::optional<Eigen::Vector2d> start =
        model_.Project(turned + *parallax * check.direction);
    if (start && !(tried[i] && (*start - *tried[i]).norm() < kOtherStart)) predicted[i] = start;
  }
  std::vector<Found> again = Follow(now, predicted);
  std::erase_if(again, [&](const Found& track) {
    return !Agrees(check, track.pair, options_.max_epipolar_error);
  });
  return again;
}

/// Hands the tracks that agree with the geometry on to `now`, in the order of last_.
void FeatureTracker::Keep(std::vector<Found> found,
                          const std::vector<std::optional<Eigen::Vector2d>>& tried,
                          const EpipolarCheck& check, TrackedImage& now) {
  std::vector<Found> kept;
  for (size_t i = 0; i < found.size(); ++i)
    if (check.agrees[i]) kept.push_back(found[i]);
  statistics_.lost_in_geometry += std::ssize(found) - std::ssize(kept);
  if (check.is_trusted) {
    const std::vector<Found> again = Retry(now, found, tried, check);
    statistics_.lost_in_flow -= std::ssize(again);
    kept.insert(kept.end(), again.begin(), again.end());
    std::sort(kept.begin(), kept.end(),
              [](const Found& a, const Found& b) { return a.origin < b.origin; });
  }
  std::vector<Eigen::Vector2d> pixels;
  pixels.reserve(kept.size());
  for (const Found& track : kept) pixels.push_back(track.observation.pixel);
  std::vector<bool> lives(last_.observations.size(), false);
  for (const Found& track : kept) lives[track.origin] = true;
  for (size_t i = 0; i < lives.size(); ++i)
    if (!memories_[i].parallax) barren_.Note(last_.observations[i].pixel, lives[i]);
  std::vector<Memory> memories;
  std::vector<double> flows;
  // Points that a rear camera leaves behind converge on its vanishing point, where their tracks
  // creep and keep near points from being found. The older of two that meet goes on.
  for (const size_t index : SuppressNonMaxima(pixels, kCrowded * detector_.min_distance())) {
    const Found& track = kept[index];
    if (!IsSet(now.usable, track.observation.pixel)) {
      ++statistics_.lost_on_own_body;
      continue;
    }
    const Eigen::Vector3d turned = check.now_from_last * track.pair.last;
    const double before =
        check.is_trusted ? ParallaxOf(turned, track.pair.now, check.direction) : 0;
    memories.push_back(Remember(std::move(memories_[track.origin]), track, now.pyramid[0]));
    memories.back().parallax = before / (turned + before * check.direction).norm();
    now.observations.push_back(track.observation);
    flows.push_back((track.observation.pixel - last_.observations[track.origin].pixel).norm());
  }
  memories_ = std::move(memories);
  direction_ = check.direction;
  median_flow_ = Median(std::move(flows));
}

/// New tracks where the image has none, but not where they would leave it at once.
void FeatureTracker::AddCorners(TrackedImage& now) {
  std::vector<Eigen::Vector2d> present;
  ParallaxField field;
  for (size_t i = 0; i < now.observations.size(); ++i) {
    present.push_back(now.observations[i].pixel);
    field.Add(now.observations[i].bearing, memories_[i].parallax.value());
  }
  const auto stays = [&](const Eigen::Vector2d& pixel) {
    if (barren_.Rests(pixel, statistics_.frames_tracked)) return false;
    const std::optional<Eigen::Vector3d> bearing = model_.Unproject(pixel);
    if (!bearing) return false;
    const auto next = model_.Project(*bearing + field.At(*bearing).value_or(0) * direction_);
    return next && IsSet(now.usable, *next);
  };
  for (const Eigen::Vector2d& pixel : detector_.Detect(now.pyramid, now.usable, present, stays)) {
    const std::optional<FeatureObservation> observation = Observe(next_track_, pixel);
    if (!observation) continue;
    now.observations.push_back(*observation);
    memories_.push_back({std::nullopt, ReferencePatch::Take(now.pyramid[0], pixel)});
    ++next_track_;
    ++statistics_.tracks_started;
  }
}

std::optional<FeatureObservation> FeatureTracker::Observe(std::int64_t track,
                                                          const Eigen::Vector2d& pixel) const {
  const std::optional<Eigen::Vector3d> bearing = model_.Unproject(pixel);
  const std::optional<double> pixels_per_radian = model_.PixelsPerRadian(pixel);
  if (!bearing || !pixels_per_radian || !(*pixels_per_radian > 0)) return std::nullopt;
  return FeatureObservation{track, pixel, *bearing, options_.pixel_sigma / *pixels_per_radian};
}

}  // namespace parkade
