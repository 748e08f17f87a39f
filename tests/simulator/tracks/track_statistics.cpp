#include "tests/simulator/tracks/track_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "core/math/statistics.h"

namespace parkade::simulator {
namespace {

constexpr int kCameraShift = 40;                     // of track numbers
constexpr double kGross = 3;                         // [px]
constexpr double kClearFlow = 2, kStuckShare = 0.3;  // [px], of it
constexpr double kSkyDistance = 1e5;                 // [m]
constexpr int kAges[] = {1, 2, 3, 5, 8, 12, 20, 30, 45};

/// One track as the world explains it.
struct Life {
  Eigen::Vector3d anchor;  ///< [m] in world
  size_t first_frame = 0, last_frame = 0;
  Eigen::Vector2d last_pixel = Eigen::Vector2d::Zero();  ///< true
  Eigen::Vector2d last_seen = Eigen::Vector2d::Zero();
  Eigen::Vector2d last_error = Eigen::Vector2d::Zero();
  bool is_done = false;  ///< ended before the last frame
};

double LowerQuantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  return NthSmallest(values, static_cast<size_t>(share * static_cast<double>(values.size() - 1)));
}

/// Standard deviation of what is normal in `values`, about zero.
double RobustSigma(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  return 1.4826 * LowerQuantile(values, 0.5);
}

class Measurement {
 public:
  Measurement(const TrackEye& eye, TrackWorld& world)
      : eye_(eye), world_(world), by_age_(std::size(kAges)) {}

  void Add(const TrackedFrame& frame) {
    world_.PlaceMovers(eye_.SecondsOf(frame.time), eye_.WorldFromBody(frame.time).translation);
    for (const FeatureObservation& seen : frame.observations) {
      if ((seen.track >> kCameraShift) != frame.camera) continue;
      ++num_observations_;
      const auto [entry, is_new] = lives_.try_emplace(seen.track);
      if (is_new)
        Begin(entry->second, seen.pixel, frame.time);
      else
        Continue(entry->second, seen.pixel, frame.time);
      entry->second.last_frame = num_frames_;
    }
    ++num_frames_;
  }

  TrackStatistics Finish() {
    TrackStatistics result;
    const double frames = std::max<double>(1, static_cast<double>(num_frames_)),
                 lives = std::max<double>(1, static_cast<double>(lives_.size())),
                 observations = std::max<double>(1, static_cast<double>(num_observations_));
    result.tracks_per_frame = static_cast<double>(num_observations_) / frames;
    result.new_per_frame = lives / frames;
    result.step = RobustSigma(steps_);
    result.outliers = static_cast<double>(num_gross_) / observations;
    result.stuck = static_cast<double>(num_stuck_) / observations;
    result.on_ground = static_cast<double>(num_ground_) / lives;
    result.in_sky = static_cast<double>(num_sky_) / lives;
    result.near = LowerQuantile(distances_, 0.25);
    result.middle = LowerQuantile(distances_, 0.5);
    result.far = LowerQuantile(distances_, 0.75);
    const std::vector<double> survival = Survival();
    for (size_t i = 0; i < by_age_.size(); ++i) {
      const Errors& errors = by_age_[i];
      const size_t age = static_cast<size_t>(kAges[i]), count = errors.along.size();
      if (count == 0 || age >= survival.size()) continue;
      result.ages.push_back({kAges[i], count, survival[age], RobustSigma(errors.along),
                             RobustSigma(errors.across),
                             static_cast<double>(errors.num_gross) / static_cast<double>(count)});
    }
    return result;
  }

 private:
  struct Errors {
    std::vector<double> along, across;
    size_t num_gross = 0;
  };

  void Begin(Life& life, const Eigen::Vector2d& pixel, Timestamp time) {
    life.first_frame = num_frames_;
    life.last_pixel = life.last_seen = pixel;
    const std::optional<SightLine> line = eye_.LineOf(pixel, time);
    if (!line) return;
    const std::optional<Sight> sight = world_.Look(line->origin, line->direction);
    life.anchor = line->origin + (sight ? sight->distance : kSkyDistance) * line->direction;
    num_ground_ += sight && sight->is_ground;
    num_sky_ += !sight;
    if (sight) distances_.push_back(sight->distance);
  }

  void Continue(Life& life, const Eigen::Vector2d& pixel, Timestamp time) {
    const std::optional<Eigen::Vector2d> truth = eye_.Project(life.anchor, time);
    if (!truth) return;
    const Eigen::Vector2d error = pixel - *truth;
    const Eigen::Vector2d flow = (*truth - life.last_pixel).normalized();
    if (error.norm() > kGross) ++num_gross_;
    const double due = (*truth - life.last_pixel).norm(), done = (pixel - life.last_seen).norm();
    if (due > kClearFlow && done < kStuckShare * due) ++num_stuck_;
    life.last_seen = pixel;
    for (const double step : {(error - life.last_error).x(), (error - life.last_error).y()})
      steps_.push_back(step);
    const size_t age = num_frames_ - life.first_frame;
    const auto found = std::find(std::begin(kAges), std::end(kAges), static_cast<int>(age));
    if (found != std::end(kAges)) {
      Errors& errors = by_age_[static_cast<size_t>(found - std::begin(kAges))];
      errors.along.push_back(flow.dot(error));
      errors.across.push_back(flow.x() * error.y() - flow.y() * error.x());
      errors.num_gross += error.norm() > kGross;
    }
    life.last_pixel = *truth;
    life.last_error = error;
  }

  /// Kaplan, Meier, "Nonparametric estimation from incomplete observations", JASA 1958.
  std::vector<double> Survival() const {
    std::vector<size_t> ended(num_frames_ + 1, 0), at_risk(num_frames_ + 2, 0);
    for (const auto& [track, life] : lives_) {
      const size_t age = life.last_frame - life.first_frame;
      const bool is_cut = life.last_frame + 1 == num_frames_;
      if (!is_cut) ++ended[age];
      // At risk of ending after each age for which the next frame is known.
      for (size_t i = 0; i + (is_cut ? 1 : 0) <= age; ++i) ++at_risk[i];
    }
    std::vector<double> survival = {1};
    for (size_t age = 0; age + 1 <= num_frames_; ++age)
      survival.push_back(at_risk[age] == 0
                             ? survival.back()
                             : survival.back() * (1 - static_cast<double>(ended[age]) /
                                                          static_cast<double>(at_risk[age])));
    return survival;
  }

  const TrackEye& eye_;
  TrackWorld& world_;
  std::map<std::int64_t, Life> lives_;
  std::vector<Errors> by_age_;
  std::vector<double> steps_, distances_;
  size_t num_frames_ = 0, num_observations_ = 0, num_gross_ = 0, num_stuck_ = 0, num_ground_ = 0,
         num_sky_ = 0;
};

}  // namespace

TrackStatistics MeasureTracks(const std::vector<TrackedFrame>& frames, const TrackEye& eye,
                              TrackWorld& world) {
  Measurement measurement(eye, world);
  for (const TrackedFrame& frame : frames)
    if (!frame.observations.empty()) measurement.Add(frame);
  return measurement.Finish();
}

std::string ToText(const TrackStatistics& statistics) {
  std::string text;
  char line[200];
  const auto add = [&](const char* format, auto... values) {
    std::snprintf(line, sizeof line, format, values...);
    text += line;
  };
  add("%.1f tracks per frame, %.1f new; ground %.0f %%, sky %.0f %%; distance quartiles %.1f %.1f "
      "%.1f m\n",
      statistics.tracks_per_frame, statistics.new_per_frame, 100 * statistics.on_ground,
      100 * statistics.in_sky, statistics.near, statistics.middle, statistics.far);
  add("step %.3f px, outliers %.2f %%, stuck %.2f %%\n", statistics.step, 100 * statistics.outliers,
      100 * statistics.stuck);
  for (const TrackErrorAtAge& age : statistics.ages)
    add("  age %2d: survival %.3f, error along %.3f across %.3f px, gross %.2f %% (%zu)\n", age.age,
        age.survival, age.along, age.across, 100 * age.gross, age.count);
  return text;
}

}  // namespace parkade::simulator
