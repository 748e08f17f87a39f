#include "tests/simulator/tracks/track_crossing.h"

#include <algorithm>
#include <cmath>

namespace parkade::simulator {

/// Two images of two cameras.
struct TrackCrossing::Views {
  const TrackSimulator &from, &to;
  Timestamp from_time, to_time;
  Rigid3 to_from_from;   ///< as the odometry believes: its rig, the true motion
  double min_depth = 0;  ///< [m] along a ray of `from`
};

std::vector<CameraPair> OverlappingPairs(const Rig& rig) {
  constexpr double kMinOverlap = 0.05;
  std::vector<CameraPair> pairs;
  for (size_t from = 0; from < rig.cameras.size(); ++from)
    for (size_t to = from + 1; to < rig.cameras.size(); ++to)
      if (ViewOverlap(rig.cameras[from], rig.cameras[to]) > kMinOverlap)
        pairs.push_back({from, to});
  return pairs;
}

TrackCrossing::TrackCrossing(TrackWorld& world, const TrackModel& model,
                             const CrossCameraOptions& options, std::uint64_t seed)
    : world_(world), model_(model), options_(options), random_(seed, 0xc205) {}

std::vector<FeatureObservation> TrackCrossing::Match(const TrackSimulator& from,
                                                     const TrackedView& image,
                                                     const TrackSimulator& to, Timestamp to_time) {
  const Rigid3 body_from_body =
      to.eye().WorldFromBody(to_time).Inverse() * from.eye().WorldFromBody(image.time);
  const Rigid3 to_from_from =
      to.nominal().body_from_camera.Inverse() * body_from_body * from.nominal().body_from_camera;
  const double baseline = to_from_from.translation.norm();
  const Views views{from,         to,
                    image.time,   to_time,
                    to_from_from, std::min(options_.min_depth, std::max(0.1, 5 * baseline))};
  world_.PlaceMovers(to.eye().SecondsOf(to_time), to.eye().WorldFromBody(to_time).translation);
  std::vector<FeatureObservation> matches;
  for (const LiveTrack& track : image.tracks) {
    if (track.is_shadow) continue;
    const std::optional<Eigen::Vector2d> pixel = Find(views, track);
    if (!pixel) continue;
    std::optional<FeatureObservation> match = to.Observe(track.number, *pixel);
    if (match && IsPlausible(views, track, *match)) matches.push_back(*match);
  }
  return matches;
}

/// Where `to` sees what the track holds on to, if it does.
std::optional<Eigen::Vector2d> TrackCrossing::Find(const Views& views, const LiveTrack& track) {
  const std::optional<SightLine> line = views.from.eye().LineOf(track.seen.pixel, views.from_time);
  if (!line) return std::nullopt;
  const double depth = (views.from.PointOf(track, views.from_time) - line->origin).norm();
  if (depth < views.min_depth) return std::nullopt;
  const Eigen::Vector3d point = line->origin + depth * line->direction;
  const std::optional<Eigen::Vector2d> pixel = views.to.eye().Project(point, views.to_time);
  if (!pixel || !views.to.IsUsable(*pixel)) return std::nullopt;
  const Eigen::Vector3d eye = views.to.eye().WorldFromCamera(views.to_time, pixel->y()).translation;
  const double angle = std::acos(
      std::clamp((eye - point).normalized().dot((line->origin - point).normalized()), -1.0, 1.0));
  // Drawn for every candidate, so that one refused for another reason leaves the rest as they are.
  const bool looks_alike =
      random_.Chance(model_.crossing * std::exp(-angle / model_.crossing_angle));
  const Eigen::Vector2d noise =
      model_.crossing_noise * track.roughness * Eigen::Vector2d(random_.Normal(), random_.Normal());
  if (!looks_alike || world_.IsHidden(eye, point)) return std::nullopt;
  return *pixel + noise;
}

/// MatchAcross's checks: off the epipolar curve, behind infinity, nearer than it searched.
bool TrackCrossing::IsPlausible(const Views& views, const LiveTrack& track,
                                const FeatureObservation& match) const {
  const Rigid3& motion = views.to_from_from;
  const Eigen::Vector3d turned = motion.rotation * track.seen.bearing;
  const double noise = options_.max_epipolar_error * match.sigma / options_.pixel_sigma;  // [rad]
  const Eigen::Vector3d off = match.bearing.cross(turned),
                        moved = match.bearing.cross(motion.translation);
  const double inverse_depth = moved.squaredNorm() > 0 ? -moved.dot(off) / moved.squaredNorm() : 0;
  if (inverse_depth * motion.translation.norm() < -noise || inverse_depth > 1.3 / views.min_depth)
    return false;
  const Eigen::Vector3d on_curve = turned + std::max(0.0, inverse_depth) * motion.translation;
  return on_curve.normalized().cross(match.bearing).norm() <= noise;
}

}  // namespace parkade::simulator
