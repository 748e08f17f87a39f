#include "slam/tracking/cross_camera_matcher.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

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
  double score = -1;  ///< normalized correlation there; -1: nothing to compare
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

/// Rays of a camera left and right of a pixel, above and below it.
struct RaysAround {
  static constexpr double kStep = 2;  ///< [px]
  Eigen::Vector3d along[2][2];        ///< by axis of the image and side
};

std::optional<RaysAround> FindRaysAround(const CameraModel& model, const Eigen::Vector2d& pixel) {
  RaysAround rays;
  for (int axis = 0; axis < 2; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const Eigen::Vector2d offset =
          (side == 0 ? -RaysAround::kStep : RaysAround::kStep) * Eigen::Vector2d::Unit(axis);
      const std::optional<Eigen::Vector3d> ray = model.Unproject(pixel + offset);
      if (!ray) return std::nullopt;
      rays.along[axis][side] = *ray;
    }
  }
  return rays;
}

/// A small plane, as a camera sees it.
struct Facet {
  Eigen::Vector3d point, normal;
};

/// d pixel in `source` / d pixel in the target, whose rays meet `facet_in_target`; central
/// differences through both lenses.
std::optional<Eigen::Matrix2d> WarpOf(const CameraModel& source, const Rigid3& source_from_target,
                                      const RaysAround& rays, const Facet& facet_in_target) {
  Eigen::Matrix2d warp;
  for (int axis = 0; axis < 2; ++axis) {
    Eigen::Vector2d ends[2];
    for (int side = 0; side < 2; ++side) {
      const Eigen::Vector3d& ray = rays.along[axis][side];
      const double range =
          facet_in_target.normal.dot(facet_in_target.point) / facet_in_target.normal.dot(ray);
      if (!(range > 0)) return std::nullopt;
      const std::optional<Eigen::Vector2d> end = source.Project(source_from_target * (range * ray));
      if (!end) return std::nullopt;
      ends[side] = *end;
    }
    warp.col(axis) = (ends[1] - ends[0]) / (2 * RaysAround::kStep);
  }
  // A patch seen from too flat an angle, or mirrored, is no use.
  if (warp.determinant() < 0.1 || warp.determinant() > 10) return std::nullopt;
  return warp;
}

/// The template of the track at `pixel_in_from`, as `to` should see it at a depth.
std::optional<PatchTemplate> TemplateFor(const Views& views, const Eigen::Vector2d& pixel_in_from,
                                         const Eigen::Vector3d& bearing,
                                         const Hypothesis& hypothesis, const RaysAround& rays,
                                         int level) {
  constexpr double kFar = 1e4;  // [m]
  const double depth = 1 / std::max(hypothesis.inverse_depth, 1 / kFar);
  const Eigen::Vector3d point_in_to = views.to_from_from * (depth * bearing);
  const Eigen::Vector3d ray_in_to = views.to_from_from.rotation * bearing;
  const Eigen::Vector3d normal =
      hypothesis.surface == Surface::kGround
          ? views.to.up_in_camera
          : Eigen::Vector3d((ray_in_to + point_in_to.normalized()).normalized());
  const auto warp = WarpOf(views.from.model, views.from_from_to, rays, Facet{point_in_to, normal});
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

/// The points of a curve with their scores: each that of the surface that fits best.
std::vector<Hypothesis> Score(const Views& views, const FeatureObservation& track,
                              std::span<const Surface> surfaces, int level,
                              std::vector<Hypothesis> curve) {
  const cv::Mat& image = views.to.pyramid[static_cast<size_t>(level)];
  std::vector<std::pair<Surface, PatchTemplate>> patches;  // of the next points
  for (size_t i = 0; i < curve.size(); ++i) {
    if (i % kSamplesPerWarp == 0) {
      patches.clear();
      Hypothesis middle = curve[std::min(i + kSamplesPerWarp / 2, curve.size() - 1)];
      const auto rays = FindRaysAround(views.to.model, middle.pixel);
      for (size_t k = 0; k < surfaces.size() && rays; ++k) {
        middle.surface = surfaces[k];
        if (auto patch = TemplateFor(views, track.pixel, track.bearing, middle, *rays, level))
          patches.emplace_back(surfaces[k], *patch);
      }
    }
    if (patches.empty()) continue;
    const auto seen =
        SamplePatch(image, curve[i].pixel / (1 << level), Eigen::Matrix2d::Identity());
    if (!seen) continue;
    for (const auto& [surface, patch] : patches) {
      const double score = Correlation(patch.values, *seen);
      if (score <= curve[i].score) continue;
      curve[i].score = score;
      curve[i].surface = surface;
    }
  }
  return curve;
}

/// The one point on the curve that looks like the track, or nothing where none does or several do.
std::optional<Hypothesis> Search(const Views& views, const FeatureObservation& track,
                                 double min_depth, int level) {
  constexpr Surface kSurfaces[] = {Surface::kFacing, Surface::kGround};
  const bool is_below_horizon = track.bearing.dot(views.from.up_in_camera) < -kMinDepression;
  const std::vector<Hypothesis> curve =
      Score(views, track, std::span(kSurfaces, is_below_horizon ? 2 : 1), level,
            SampleCurve(views, track.bearing, min_depth, level));
  const auto best =
      std::max_element(curve.begin(), curve.end(),
                       [](const Hypothesis& a, const Hypothesis& b) { return a.score < b.score; });
  if (best == curve.end() || best->score < kMinSearchCorrelation) return std::nullopt;
  const double near = 4.0 * (1 << level);  // [px] the flanks of the best itself
  for (const Hypothesis& other : curve) {
    if ((other.pixel - best->pixel).norm() < near) continue;
    if (1 - best->score > kMaxAmbiguity * (1 - other.score)) return std::nullopt;
  }
  return *best;
}

/// From the search level down to the full image.
std::optional<PatchMatch> RefineIn(const Views& views, const FeatureObservation& track,
                                   const Hypothesis& hypothesis, int level) {
  PatchMatch match{hypothesis.pixel, 0};
  const auto rays = FindRaysAround(views.to.model, hypothesis.pixel);
  if (!rays) return std::nullopt;
  for (; level >= 0; --level) {
    const auto patch = TemplateFor(views, track.pixel, track.bearing, hypothesis, *rays, level);
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
  const auto rays = FindRaysAround(back.to.model, start.pixel);
  if (!rays) return false;
  const auto patch = TemplateFor(back, match.pixel, match.bearing, start, *rays, 0);
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
