#include "tests/simulator/tracks/track_simulator.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "slam/tracking/image_pyramid.h"
#include "slam/tracking/non_maximum_suppression.h"

namespace parkade::simulator {
namespace {

constexpr int kCameraShift = 40;      // of track numbers
constexpr double kSkyDistance = 1e5;  // [m]
constexpr double kMovingFlow = 1;     // [px]
constexpr double kMaxPerCell = 4;
constexpr int kTriesPerCell = 3;

/// What happens to the look of a patch between two eyes: see TrackModel.
struct Change {
  double area = 0;   ///< of the logarithm of its area in the image: > 0 growing
  double angle = 0;  ///< [rad] by which it is seen from elsewhere

  double Total() const { return std::abs(area) + angle; }
};

Change ChangeOf(const LiveTrack& track, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d before = from - track.anchor, now = to - track.anchor;
  const double near = before.norm(), far = now.norm();
  constexpr double kGrazing = 0.02;
  const double tilt_before = std::max(kGrazing, std::abs(track.normal.dot(before) / near)),
               tilt_now = std::max(kGrazing, std::abs(track.normal.dot(now) / far));
  const double area = 2 * std::log(near / far) + std::log(tilt_now / tilt_before);
  return {area, std::acos(std::clamp(before.dot(now) / (near * far), -1.0, 1.0))};
}

}  // namespace

void TrackModel::Validate() const {
  Require(white >= 0 && blur >= 0 && drift >= 0 && roughness >= 0 && crossing_noise >= 0 &&
              loss_per_growth >= 0 && loss_per_flow >= 0 && loss_new >= 0 && frailty >= 0 &&
              slide >= 0 && slide_across >= 0 && slide_age > 0 && slide_beside >= 0 &&
              slide_limit >= 0,
          ErrorCode::kUsage, "noise and losses of tracks must not be negative");
  Require(crossing_angle > 0, ErrorCode::kUsage, "the crossing angle must be positive");
  for (const double share : {edges, loss, jump, texture, sky, shadow, crossing})
    Require(share >= 0 && share <= 1, ErrorCode::kUsage,
            "shares and chances of tracks must be in 0..1");
}

TrackSimulator::TrackSimulator(const TrackEye& eye, const RigCamera& nominal, int camera_index,
                               TrackWorld& world, const TrackModel& model, std::uint64_t seed,
                               const FeatureTrackerOptions& options)
    : eye_(eye),
      nominal_(nominal),
      camera_(camera_index),
      world_(world),
      model_((model.Validate(), model)),
      options_((options.Validate(), options)),
      random_(seed, 0x7ac + static_cast<std::uint64_t>(camera_index)),
      usable_(UsablePixels(nominal.model, nominal.mask, options.window / 2)),
      next_track_(static_cast<std::int64_t>(camera_index) << kCameraShift) {
  const double area = std::max(1, cv::countNonZero(usable_));
  cell_size_ = std::max(
      8, static_cast<int>(std::sqrt(area / options.max_tracks)) / 4 * 4);  // as CornerDetector
  spacing_ = 0.6 * cell_size_;
}

bool TrackSimulator::IsUsable(const Eigen::Vector2d& pixel) const {
  const int x = static_cast<int>(std::lround(pixel.x())),
            y = static_cast<int>(std::lround(pixel.y()));
  return x >= 0 && y >= 0 && x < usable_.cols && y < usable_.rows &&
         usable_.at<std::uint8_t>(y, x) != 0;
}

Eigen::Vector2d TrackSimulator::Noise(double sigma) {
  const double x = random_.Normal(), y = random_.Normal();
  return {sigma * x, sigma * y};
}

Eigen::Vector3d TrackSimulator::PointOf(const LiveTrack& track, Timestamp time) const {
  return track.mover ? track.mover->world_from_mover(eye_.SecondsOf(time)) * track.anchor
                     : track.anchor;
}

std::optional<Eigen::Vector2d> TrackSimulator::TruePixel(const LiveTrack& track,
                                                         Timestamp time) const {
  if (track.is_shadow)
    return eye_.camera().model.Project(eye_.camera().body_from_camera.Inverse() * track.anchor);
  std::optional<Eigen::Vector2d> pixel = eye_.Project(PointOf(track, time), time);
  if (!pixel || !track.behind) return pixel;
  const std::optional<Eigen::Vector2d> behind = eye_.Project(*track.behind, time);
  if (!behind) return std::nullopt;
  return *pixel + track.behind_share * (*behind - *pixel);
}

TrackedFrame TrackSimulator::Track(Timestamp time, Timestamp stamp) {
  world_.PlaceMovers(eye_.SecondsOf(time), eye_.WorldFromBody(time).translation);
  if (last_time_ && time - *last_time_ > options_.max_gap) tracks_.clear();
  std::vector<LiveTrack> now;
  for (LiveTrack& track : tracks_)
    if (std::optional<LiveTrack> followed = Follow(std::move(track), time))
      now.push_back(std::move(*followed));
  if (last_time_) DropDisagreeing(now, time);
  DropCrowded(now);
  tracks_ = std::move(now);
  AddCorners(time);
  last_time_ = time;
  TrackedFrame frame{stamp, camera_, {}};
  for (const LiveTrack& track : tracks_) frame.observations.push_back(track.seen);
  return frame;
}

std::optional<LiveTrack> TrackSimulator::Follow(LiveTrack track, Timestamp time) {
  const std::optional<Eigen::Vector2d> pixel = TruePixel(track, time);
  if (!pixel || !IsUsable(*pixel)) return std::nullopt;
  const Rigid3 world_from_camera = eye_.WorldFromCamera(time, pixel->y());
  const Eigen::Vector3d eye = world_from_camera.translation;
  const bool is_still = !track.is_shadow && !track.mover;
  const Change change = is_still ? ChangeOf(track, track.eye, eye) : Change{};
  if (!track.is_shadow && world_.IsHidden(eye, PointOf(track, time))) return std::nullopt;
  const Eigen::Vector2d flow = *pixel - track.true_pixel;
  if (IsLost(track, std::max(0.0, change.area), flow.norm())) return std::nullopt;
  track.drift += Noise(model_.drift * track.roughness * std::sqrt(change.Total()));
  ++track.age;
  const Eigen::Vector3d sight = world_from_camera.rotation * Eigen::Vector3d::UnitZ();
  Slide(track, flow, std::abs(change.area), sight.dot((eye - track.eye).normalized()));
  if (flow.norm() > kMovingFlow && random_.Chance(model_.jump)) {
    const double angle = random_.Uniform(0, 2 * M_PI), reach = random_.Uniform(3, 10);
    track.drift += reach * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  const auto seen = Observe(
      track.number,
      *pixel + track.drift +
          Noise(track.roughness * std::hypot(model_.white, model_.blur * std::sqrt(flow.norm()))));
  if (!seen || !IsUsable(seen->pixel)) return std::nullopt;
  track.true_pixel = *pixel;
  track.eye = eye;
  track.seen_before = track.seen.bearing;
  track.seen = *seen;
  return track;
}

/// The error that patches gather as their look changes. From image to image the slides of a track
/// are alike. A camera that looks along its way, forwards or backwards, sees patches stretch: there
/// they slide the more, as the first look fades.
void TrackSimulator::Slide(LiveTrack& track, const Eigen::Vector2d& flow, double growth,
                           double sight_along_way) {
  if (flow.squaredNorm() == 0) return;
  const Eigen::Vector2d along = flow.normalized(), across(-along.y(), along.x());
  const double ahead = sight_along_way * sight_along_way,
               fading = track.age / (track.age + model_.slide_age);
  const double reach = (1 - ahead) * model_.slide_beside * growth +
                       ahead * model_.slide * fading * std::min(growth, model_.slide_limit);
  track.drift += reach * (track.slide.x() * along + model_.slide_across * track.slide.y() * across);
}

bool TrackSimulator::IsLost(const LiveTrack& track, double growth, double flow) {
  const bool is_new = track.seen_before.squaredNorm() == 0;
  const double hazard =
      track.frailty * (model_.loss + model_.loss_per_growth * growth +
                       (is_new ? model_.loss_new : model_.loss_per_flow) * flow * flow / 100);
  return random_.Chance(1 - std::exp(-hazard));
}

/// By the very check of the real tracker, with the rotation that a gyroscope would predict.
void TrackSimulator::DropDisagreeing(std::vector<LiveTrack>& tracks, Timestamp time) const {
  const Eigen::Matrix3d now_from_last =
      (eye_.WorldFromCamera(time).rotation.conjugate() * eye_.WorldFromCamera(*last_time_).rotation)
          .toRotationMatrix();
  std::vector<BearingPair> pairs;
  for (const LiveTrack& track : tracks)
    pairs.push_back(
        {track.seen_before, track.seen.bearing, track.seen.sigma / options_.pixel_sigma});
  const EpipolarCheck check =
      CheckEpipolarGeometry(pairs, now_from_last, options_.max_epipolar_error);
  size_t kept = 0;
  for (size_t i = 0; i < tracks.size(); ++i)
    if (check.agrees[i]) {
      if (kept != i) tracks[kept] = std::move(tracks[i]);
      ++kept;
    }
  tracks.resize(kept);
}

/// The older of two tracks that meet goes on, as in the real tracker.
void TrackSimulator::DropCrowded(std::vector<LiveTrack>& tracks) const {
  std::vector<Eigen::Vector2d> pixels;
  for (const LiveTrack& track : tracks) pixels.push_back(track.seen.pixel);
  std::vector<LiveTrack> kept;
  for (const size_t index : SuppressNonMaxima(pixels, kCrowded * spacing_))
    kept.push_back(std::move(tracks[index]));
  tracks = std::move(kept);
}

/// One corner in every empty cell first, then two, as long as there is room: see CornerDetector.
void TrackSimulator::AddCorners(Timestamp time) {
  const int columns = (usable_.cols + cell_size_ - 1) / cell_size_,
            rows = (usable_.rows + cell_size_ - 1) / cell_size_;
  std::vector<int> num_in_cell(static_cast<size_t>(columns * rows), 0);
  std::vector<Eigen::Vector2d> present;
  const auto take = [&](const Eigen::Vector2d& pixel) {
    const int column = std::clamp(static_cast<int>(pixel.x()) / cell_size_, 0, columns - 1),
              row = std::clamp(static_cast<int>(pixel.y()) / cell_size_, 0, rows - 1);
    ++num_in_cell[static_cast<size_t>(row * columns + column)];
    present.push_back(pixel);
  };
  for (const LiveTrack& track : tracks_) take(track.seen.pixel);
  std::vector<int> order(num_in_cell.size());
  std::iota(order.begin(), order.end(), 0);
  for (size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[static_cast<size_t>(random_.Index(static_cast<int>(i)))]);
  for (int per_cell = 1; per_cell <= kMaxPerCell; ++per_cell) {
    for (const int cell : order) {
      if (std::ssize(tracks_) >= options_.max_tracks) return;
      if (num_in_cell[static_cast<size_t>(cell)] >= per_cell) continue;
      for (int attempt = 0; attempt < kTriesPerCell; ++attempt) {
        const Eigen::Vector2d pixel((cell % columns + random_.Uniform()) * cell_size_,
                                    (cell / columns + random_.Uniform()) * cell_size_);
        if (!IsUsable(pixel)) continue;
        if (std::any_of(present.begin(), present.end(), [&](const Eigen::Vector2d& other) {
              return (other - pixel).norm() < spacing_;
            }))
          continue;
        std::optional<LiveTrack> corner = Corner(pixel, time);
        if (!corner) continue;
        take(pixel);
        tracks_.push_back(std::move(*corner));
        break;
      }
    }
  }
}

std::optional<LiveTrack> TrackSimulator::Corner(const Eigen::Vector2d& pixel, Timestamp time) {
  const std::optional<SightLine> line = eye_.LineOf(pixel, time);
  if (!line) return std::nullopt;
  const std::optional<Sight> sight = world_.Look(line->origin, line->direction);
  LiveTrack track;
  const double distance = sight ? sight->distance : kSkyDistance;
  track.anchor = line->origin + distance * line->direction;
  track.normal = sight ? sight->normal : Eigen::Vector3d(-line->direction);
  track.eye = line->origin;
  const bool is_outline = IsAtOutline(track, *line, distance, time);
  if (!is_outline && !random_.Chance(sight ? model_.texture : model_.sky)) return std::nullopt;
  if (track.is_shadow) track.anchor = eye_.WorldFromBody(time).Inverse() * track.anchor;
  if (sight && sight->mover && !track.is_shadow) {
    track.mover = sight->mover;
    track.anchor = track.mover->world_from_mover(eye_.SecondsOf(time)).Inverse() * track.anchor;
  }
  const std::optional<Eigen::Vector2d> true_pixel = TruePixel(track, time);
  if (!true_pixel) return std::nullopt;
  track.roughness = std::exp(model_.roughness * random_.Normal());
  track.slide = Noise(1);
  track.frailty = std::exp(model_.frailty * random_.Normal());
  track.true_pixel = *true_pixel;
  track.number = next_track_;
  const auto seen = Observe(track.number, *true_pixel + Noise(model_.white * track.roughness));
  if (!seen) return std::nullopt;
  ++next_track_;
  track.seen = *seen;
  return track;
}

/// Corners are found where something ends: there a patch holds two surfaces, or
/// light and the own car's shadow. Notes what the track then holds on to.
bool TrackSimulator::IsAtOutline(LiveTrack& track, const SightLine& line, double distance,
                                 Timestamp time) {
  constexpr double kBeside = 5;    // [px]
  constexpr double kBehind = 1.3;  // times the distance is another surface
  const double angle = random_.Uniform(0, 2 * M_PI);
  const auto pixel = eye_.Project(track.anchor, time);
  if (!pixel) return false;
  const auto beside =
      eye_.LineOf(*pixel + kBeside * Eigen::Vector2d(std::cos(angle), std::sin(angle)), time);
  if (!beside) return false;
  const std::optional<Sight> sight = world_.Look(beside->origin, beside->direction);
  const double other = sight ? sight->distance : kSkyDistance;
  if (std::max(other, distance) > kBehind * std::min(other, distance)) {
    if (random_.Chance(model_.edges)) {
      track.behind = line.origin + other * line.direction;
      track.behind_share = random_.Uniform();
    }
    return true;
  }
  if (!sight || !sight->is_ground) return false;
  const Rigid3 world_from_body = eye_.WorldFromBody(time);
  if (IsOnOwnShadow(track.anchor, world_from_body) == IsOnOwnShadow(sight->point, world_from_body))
    return false;
  track.is_shadow = random_.Chance(model_.shadow);
  return true;
}

bool TrackSimulator::IsOnOwnShadow(const Eigen::Vector3d& point,
                                   const Rigid3& world_from_body) const {
  const Rigid3 body_from_world = world_from_body.Inverse();
  return world_.OwnCarHides(body_from_world * point, body_from_world.rotation * world_.to_sun());
}

std::optional<FeatureObservation> TrackSimulator::Observe(std::int64_t track,
                                                          const Eigen::Vector2d& pixel) const {
  const std::optional<Eigen::Vector3d> bearing = nominal_.model.Unproject(pixel);
  const std::optional<double> pixels_per_radian = nominal_.model.PixelsPerRadian(pixel);
  if (!bearing || !pixels_per_radian || !(*pixels_per_radian > 0)) return std::nullopt;
  return FeatureObservation{track, pixel, *bearing, options_.pixel_sigma / *pixels_per_radian};
}

}  // namespace parkade::simulator
