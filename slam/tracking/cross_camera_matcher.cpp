#include "slam/tracking/cross_camera_matcher.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "slam/tracking/patch_alignment.h"

namespace parkade {
namespace {

constexpr int kSearchLevel = 1;   ///< of the pyramid
constexpr double kSpacing = 1.5;  ///< [px of that level] between two points on the curve
constexpr double kMinSearchCorrelation = 0.5;  ///< at the search level
constexpr double kMaxAmbiguity = 0.8;          ///< (1 - best) / (1 - second best) along the curve
constexpr int kSamplesPerWarp = 6;          ///< a patch warped for one depth serves its neighbors
constexpr int kMaxSamples = 200;            ///< along one epipolar curve
constexpr double kMinDepthPerBaseline = 5;  ///< cameras close to each other share near points, too
constexpr double kMinDepth = 0.1;           ///< [m]
constexpr double kMinDepression = 0.1;  ///< [rad] below the horizon a point may lie on the ground
constexpr double kMaxReturn = 1.0;      ///< [px] backward check

/// Two images and the motion between their cameras.
struct Views {
  const TrackedImage& from;
  const TrackedImage& to;
  Rigid3 to_from_from;
  Rigid3 from_from_to;
};

/// What surface a patch is taken to lie on: it decides how the two lenses see it.
enum class Surface {
  kFacing,  ///< turned toward both cameras: walls, signs, pillars
  kGround,  ///< flat on the ground
};

/// A point on the epipolar curve of one track.
struct Hypothesis {
  double inverse_depth = 0;  ///< [1/m] along the ray of `from`
  Eigen::Vector2d pixel;     ///< in `to`
  Surface surface = Surface::kFacing;
};

/// What the ray at an inverse depth shows in `to`; nothing outside its usable pixels.
std::optional<Hypothesis> HypothesisAt(const Views& views, const Eigen::Vector3d& bearing,
                                       double inverse_depth) {
  const Eigen::Vector3d point =
      views.to_from_from.rotation * bearing + inverse_depth * views.to_from_from.translation;
  const std::optional<Eigen::Vector2d> pixel = views.to.model.Project(point);
  if (!pixel || !views.to.model.IsInImage(*pixel)) return std::nullopt;
  if (views.to.usable.at<std::uint8_t>(static_cast<int>(pixel->y()),
                                       static_cast<int>(pixel->x())) == 0)
    return std::nullopt;
  return Hypothesis{inverse_depth, *pixel};
}

/// d pixel in `source` / d pixel in `target` for a small plane through
/// `point_in_target` with `normal_in_target`; central differences through both lenses.
std::optional<Eigen::Matrix2d> WarpOf(const CameraModel& source, const CameraModel& target,
                                      const Rigid3& source_from_target,
                                      const Eigen::Vector3d& point_in_target,
                                      const Eigen::Vector2d& pixel_in_target,
                                      const Eigen::Vector3d& normal_in_target) {
  constexpr double kStep = 2;  // [px]
  Eigen::Matrix2d warp;
  for (int axis = 0; axis < 2; ++axis) {
    Eigen::Vector2d ends[2];
    for (int side = 0; side < 2; ++side) {
      const Eigen::Vector2d offset = (side == 0 ? -kStep : kStep) * Eigen::Vector2d::Unit(axis);
      const std::optional<Eigen::Vector3d> ray = target.Unproject(pixel_in_target + offset);
      if (!ray) return std::nullopt;
      const double range = normal_in_target.dot(point_in_target) / normal_in_target.dot(*ray);
      if (!(range > 0)) return std::nullopt;
      const std::optional<Eigen::Vector2d> end =
          source.Project(source_from_target * (range * *ray));
      if (!end) return std::nullopt;
      ends[side] = *end;
    }
    warp.col(axis) = (ends[1] - ends[0]) / (2 * kStep);
  }
  // A patch seen from too flat an angle, or mirrored, is no use.
  if (warp.determinant() < 0.1 || warp.determinant() > 10) return std::nullopt;
  return warp;
}

/// The template of the track at `pixel_in_from`, as `to` should see it at a depth.
std::optional<PatchTemplate> TemplateFor(const Views& views, const Eigen::Vector2d& pixel_in_from,
                                         const Eigen::Vector3d& bearing,
                                         const Hypothesis& hypothesis, int level) {
  constexpr double kFar = 1e4;  // [m]
  const double depth = 1 / std::max(hypothesis.inverse_depth, 1 / kFar);
  const Eigen::Vector3d point_in_to = views.to_from_from * (depth * bearing);
  const Eigen::Vector3d ray_in_to = views.to_from_from.rotation * bearing;
  const Eigen::Vector3d normal =
      hypothesis.surface == Surface::kGround
          ? views.to.up_in_camera
          : Eigen::Vector3d((ray_in_to + point_in_to.normalized()).normalized());
  const auto warp = WarpOf(views.from.model, views.to.model, views.from_from_to, point_in_to,
                           hypothesis.pixel, normal);
  if (!warp) return std::nullopt;
  return MakeTemplate(views.from.pyramid[static_cast<size_t>(level)], pixel_in_from / (1 << level),
                      *warp);
}

/// Points on the epipolar curve from infinity to `min_depth`, kSpacing pixels of `level` apart.
std::vector<Hypothesis> SampleCurve(const Views& views, const Eigen::Vector3d& bearing,
                                    double min_depth, int level) {
  constexpr int kCoarse = 12;
  double length = 0;
  std::optional<Hypothesis> last;
  for (int i = 0; i <= kCoarse; ++i) {
    const auto next = HypothesisAt(views, bearing, i / (kCoarse * min_depth));
    if (next && last) length += (next->pixel - last->pixel).norm();
    if (next && !last) length += 1;  // a piece begins
    last = next;
  }
  std::vector<Hypothesis> curve;
  if (length == 0) return curve;
  const int count =
      std::clamp(static_cast<int>(length / (kSpacing * (1 << level))), kCoarse, kMaxSamples);
  for (int i = 0; i <= count; ++i) {
    const auto next = HypothesisAt(views, bearing, i / (count * min_depth));
    if (next) curve.push_back(*next);
  }
  return curve;
}

/// Normalized correlation at each point of the curve; -1 where there is none.
std::vector<double> Score(const Views& views, const FeatureObservation& track,
                          const std::vector<Hypothesis>& curve, int level) {
  const cv::Mat& image = views.to.pyramid[static_cast<size_t>(level)];
  std::vector<double> scores(curve.size(), -1.0);
  std::optional<PatchTemplate> patch;
  for (size_t i = 0; i < curve.size(); ++i) {
    if (i % kSamplesPerWarp == 0) {
      const size_t middle = std::min(i + kSamplesPerWarp / 2, curve.size() - 1);
      patch = TemplateFor(views, track.pixel, track.bearing, curve[middle], level);
    }
    if (!patch) continue;
    const auto seen =
        SamplePatch(image, curve[i].pixel / (1 << level), Eigen::Matrix2d::Identity());
    if (seen) scores[i] = Correlation(patch->values, *seen);
  }
  return scores;
}

/// The one point on the curve that looks like the track, or nothing where none does or several do.
std::optional<Hypothesis> Search(const Views& views, const FeatureObservation& track,
                                 double min_depth, int level) {
  std::vector<Hypothesis> curve = SampleCurve(views, track.bearing, min_depth, level);
  if (curve.empty()) return std::nullopt;
  std::vector<double> scores = Score(views, track, curve, level);
  if (track.bearing.dot(views.from.up_in_camera) < -kMinDepression) {
    for (Hypothesis& place : curve) place.surface = Surface::kGround;
    const std::vector<double> on_ground = Score(views, track, curve, level);
    for (size_t i = 0; i < curve.size(); ++i) {
      if (scores[i] >= on_ground[i]) curve[i].surface = Surface::kFacing;
      scores[i] = std::max(scores[i], on_ground[i]);
    }
  }
  const auto best = std::max_element(scores.begin(), scores.end());
  if (*best < kMinSearchCorrelation) return std::nullopt;
  const auto best_index = static_cast<size_t>(best - scores.begin());
  const double near = 4.0 * (1 << level);  // [px] the flanks of the best itself
  for (size_t i = 0; i < curve.size(); ++i) {
    if ((curve[i].pixel - curve[best_index].pixel).norm() < near) continue;
    if (1 - *best > kMaxAmbiguity * (1 - scores[i])) return std::nullopt;
  }
  return curve[best_index];
}

/// From the search level down to the full image.
std::optional<PatchMatch> RefineIn(const Views& views, const FeatureObservation& track,
                                   const Hypothesis& hypothesis, int level) {
  PatchMatch match{hypothesis.pixel, 0};
  for (; level >= 0; --level) {
    const auto patch = TemplateFor(views, track.pixel, track.bearing, hypothesis, level);
    if (!patch) return std::nullopt;
    const auto aligned = AlignPatch(*patch, views.to.pyramid[static_cast<size_t>(level)],
                                    match.pixel / (1 << level), 3.0);
    if (!aligned) return std::nullopt;
    match = {aligned->pixel * (1 << level), aligned->correlation};
  }
  return match;
}

/// Inverse depth [1/m] of the point nearest to both rays, along the ray of `from`.
double InverseDepth(const Views& views, const Eigen::Vector3d& bearing,
                    const Eigen::Vector3d& bearing_in_to) {
  // bearing_in_to x (R b + w t) = 0, least squares in w.
  const Eigen::Vector3d turned = bearing_in_to.cross(views.to_from_from.rotation * bearing);
  const Eigen::Vector3d moved = bearing_in_to.cross(views.to_from_from.translation);
  const double squared = moved.squaredNorm();
  return squared > 0 ? -moved.dot(turned) / squared : 0;
}

/// True where a patch of `to` finds its way back to the track.
bool ReturnsTo(const FeatureObservation& track, const Views& views, const FeatureObservation& match,
               double inverse_depth, Surface surface) {
  const Views back{views.to, views.from, views.from_from_to, views.to_from_from};
  const double depth = 1 / std::max(inverse_depth, 1e-4);
  const double depth_in_to = (views.to_from_from * (depth * track.bearing)).norm();
  const Hypothesis start{1 / depth_in_to, track.pixel, surface};
  const auto patch = TemplateFor(back, match.pixel, match.bearing, start, 0);
  if (!patch) return false;
  const auto aligned =
      AlignPatch(*patch, views.from.pyramid[0], track.pixel + Eigen::Vector2d(1, -1), 4.0);
  return aligned && (aligned->pixel - track.pixel).norm() < kMaxReturn;
}

std::optional<FeatureObservation> MatchOne(const Views& views, const FeatureObservation& track,
                                           const CrossCameraOptions& options) {
  const int top =
      static_cast<int>(std::min(views.from.pyramid.size(), views.to.pyramid.size())) - 1;
  const int level = std::min(top, kSearchLevel);
  const double baseline = views.to_from_from.translation.norm();
  const double min_depth =
      std::min(options.min_depth, std::max(kMinDepth, kMinDepthPerBaseline * baseline));
  const auto found = Search(views, track, min_depth, level);
  if (!found) return std::nullopt;
  const auto match = RefineIn(views, track, *found, level);
  if (!match || match->correlation < options.min_similarity) return std::nullopt;

  const auto bearing = views.to.model.Unproject(match->pixel);
  const double pixels_per_radian = views.to.model.PixelsPerRadian(match->pixel).value_or(0);
  if (!bearing || !(pixels_per_radian > 0)) return std::nullopt;
  const double inverse_depth = InverseDepth(views, track.bearing, *bearing);
  const double noise = options.max_epipolar_error / pixels_per_radian;  // [rad]
  if (inverse_depth * baseline < -noise || inverse_depth > 1.3 / min_depth) return std::nullopt;
  const Eigen::Vector3d on_curve = views.to_from_from.rotation * track.bearing +
                                   std::max(0.0, inverse_depth) * views.to_from_from.translation;
  if (on_curve.normalized().cross(*bearing).norm() > noise) return std::nullopt;
  const FeatureObservation observation{track.track, match->pixel, *bearing,
                                       options.pixel_sigma / pixels_per_radian};
  if (!ReturnsTo(track, views, observation, inverse_depth, found->surface)) return std::nullopt;
  return observation;
}

}  // namespace

void CrossCameraOptions::Validate() const {
  Require(min_depth > 0, ErrorCode::kUsage, "min_depth must be > 0 m");
  Require(min_similarity > 0 && min_similarity < 1, ErrorCode::kUsage,
          "min_similarity must be in (0, 1)");
  Require(max_epipolar_error > 0, ErrorCode::kUsage, "max_epipolar_error must be > 0 px");
  Require(pixel_sigma > 0, ErrorCode::kUsage, "pixel_sigma must be > 0 px");
}

double ViewOverlap(const RigCamera& a, const RigCamera& b, double min_depth) {
  constexpr int kGrid = 32;
  const Rigid3 b_from_a = b.body_from_camera.Inverse() * a.body_from_camera;
  int num_rays = 0, num_shared = 0;
  for (int row = 0; row < kGrid; ++row) {
    for (int column = 0; column < kGrid; ++column) {
      const Eigen::Vector2d pixel((column + 0.5) * a.model.width() / kGrid,
                                  (row + 0.5) * a.model.height() / kGrid);
      const auto bearing = a.model.Unproject(pixel);
      if (!bearing) continue;
      ++num_rays;
      for (const double share :
           {0.0, 0.1, 0.3, 1.0}) {  // as a share of 1 / min_depth, from infinity inwards
        const Eigen::Vector3d point =
            b_from_a.rotation * *bearing + share / min_depth * b_from_a.translation;
        const auto seen = b.model.Project(point);
        if (!seen || !b.model.IsInImage(*seen)) continue;
        ++num_shared;
        break;
      }
    }
  }
  return num_rays == 0 ? 0 : static_cast<double>(num_shared) / num_rays;
}

std::vector<FeatureObservation> MatchAcross(const TrackedImage& from, const TrackedImage& to,
                                            const Rigid3& to_from_from,
                                            const CrossCameraOptions& options) {
  options.Validate();
  std::vector<FeatureObservation> matches;
  if (from.empty() || to.empty()) return matches;
  const Views views{from, to, to_from_from, to_from_from.Inverse()};
  for (const FeatureObservation& track : from.observations) {
    const auto match = MatchOne(views, track, options);
    if (match) matches.push_back(*match);
  }
  return matches;
}

}  // namespace parkade
