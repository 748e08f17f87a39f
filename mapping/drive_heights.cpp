#include "mapping/drive_heights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "core/log.h"
#include "core/parallel.h"
#include "mapping/estimate_lean.h"
#include "mapping/height_certainty.h"

namespace parkade {
namespace {

constexpr double kLeastPlaneVariance = 4e-4;  // [m^2] of a keyframe's plane: wheels and the sweep are surer
constexpr double kPoseDistance = 0.5;         // [m] between poses that heights may be tied to
constexpr double kPoseSquare = 8.0;           // [m] of the squares in which these are sorted
constexpr size_t kPatchesPerBatch = 64;       // in memory at once

/// The heights at which patches put the ground: the planes that their cars stood on.
class PlaneHeights {
 public:
  explicit PlaneHeights(const HeightFieldOptions& options = {}) : options_(options) {}

  /// `path` is that of its drive, or null.
  void Add(const PosedGroundPatch& posed, const DrivenPath* path) {
    const Rigid3 ground_from_body = path ? path->body_from_ground.Inverse() : Rigid3{};
    const Eigen::Vector2d acceleration =
        path ? AccelerationAt(path->site_from_body, posed.patch.time) : Eigen::Vector2d::Zero();
    const double share = path ? path->plane_errors * path->plane_errors : 1;
    for (const GroundSample& sample : posed.patch.samples) {
      if (!sample.is_free) continue;
      const Eigen::Vector3d point_in_body = sample.point_in_body.cast<double>();
      Eigen::Vector3d point = posed.site_from_body * point_in_body;
      if (path) point.z() -= path->lean.LiftAt(acceleration, (ground_from_body * point_in_body).head<2>());
      const double weight = 1 / (share / static_cast<double>(sample.weight) + kLeastPlaneVariance);
      Add(point, weight, weight);
    }
  }

  void Add(const Eigen::Vector3d& point, double weight, double best_weight) {
    const auto index = [](double value, double step) { return static_cast<int>(std::floor(value / step)); };
    Sum& sum = sums_[{index(point.z(), options_.level_separation), index(point.y(), options_.spacing),
                      index(point.x(), options_.spacing)}];
    sum.point += weight * point;
    sum.weight += weight;
    sum.best_weight = std::max(sum.best_weight, best_weight);
  }

  void Merge(const PlaneHeights& other) {
    for (const auto& [square, sum] : other.sums_) {
      Sum& here = sums_[square];
      here.point += sum.point;
      here.weight += sum.weight;
      here.best_weight = std::max(here.best_weight, sum.best_weight);
    }
  }

  /// One per square and deck; the weight of all of them, and the sigma of the best.
  std::vector<HeightObservation> Sums() const {
    std::vector<HeightObservation> sums;
    sums.reserve(sums_.size());
    for (const auto& [square, sum] : sums_)
      sums.push_back({sum.point / sum.weight, sum.weight, 1 / std::sqrt(sum.best_weight)});
    return sums;
  }

  /// One per square and deck, with `share` of the weight of the best.
  std::vector<HeightObservation> Observations(double share) const {
    std::vector<HeightObservation> observations;
    observations.reserve(sums_.size());
    for (const auto& [square, sum] : sums_) observations.push_back({sum.point / sum.weight, share * sum.best_weight});
    return observations;
  }

 private:
  struct Sum {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double weight = 0, best_weight = 0;
  };
  HeightFieldOptions options_;
  std::map<std::tuple<int, int, int>, Sum> sums_;
};

PlaneHeights CollectPlanes(const PatchSource& patches, const DrivenPath* path, const HeightOptions& options) {
  PlaneHeights planes(options.field);
  const size_t count = patches.views().size();
  for (size_t begin = 0; begin < count; begin += kPatchesPerBatch) {
    const auto of_patches = ParallelMap(std::min(kPatchesPerBatch, count - begin), [&](size_t i) {
      PlaneHeights heights(options.field);
      heights.Add(patches.Read(begin + i), path);
      return heights;
    });
    for (const PlaneHeights& heights : of_patches) planes.Merge(heights);
  }
  return planes;
}

void AddContacts(const DrivenPath& path, const HeightOptions& options, std::vector<HeightObservation>& observations) {
  for (const ContactPoint& contact : FindContacts(path, 0.5 * options.field.spacing)) {
    const double lever = contact.is_front ? path.contact.wheelbase * options.suspension_sigma : 0;
    const double variance = options.contact_sigma * options.contact_sigma + lever * lever;
    observations.push_back({contact.point_in_site, 1 / variance});
  }
}

/// Ties points of site to the poses of a path that are nearest to them.
class PoseTies {
 public:
  explicit PoseTies(const DrivenPath* path) {
    if (path == nullptr) return;
    const TrajectoryState* last = nullptr;
    for (const TrajectoryState& state : path->site_from_body.states()) {
      const Eigen::Vector3d& place = state.odom_from_body.translation;
      if (last && (place - last->odom_from_body.translation).norm() < kPoseDistance) continue;
      last = &state;
      poses_.push_back(&state);
      squares_[SquareOf(place)].push_back(&state);
    }
  }

  DriveHeight Tie(const HeightObservation& height) const {
    DriveHeight tied{
        {}, height.point_in_site.cast<float>(), static_cast<float>(height.weight), static_cast<float>(height.sigma)};
    if (const TrajectoryState* pose = NearestTo(height.point_in_site)) {
      tied.time = pose->time;
      tied.point_in_body = (pose->odom_from_body.Inverse() * height.point_in_site).cast<float>();
    }
    return tied;
  }

 private:
  static std::pair<int, int> SquareOf(const Eigen::Vector3d& point) {
    return {static_cast<int>(std::floor(point.x() / kPoseSquare)),
            static_cast<int>(std::floor(point.y() / kPoseSquare))};
  }

  /// Of the squares around a point, or of all where these are empty.
  const TrajectoryState* NearestTo(const Eigen::Vector3d& point) const {
    const TrajectoryState* nearest = nullptr;
    double least = std::numeric_limits<double>::max();
    const auto look = [&](const std::vector<const TrajectoryState*>& poses) {
      for (const TrajectoryState* pose : poses) {
        const double distance = (pose->odom_from_body.translation - point).squaredNorm();
        if (distance < least) least = distance, nearest = pose;
      }
    };
    const auto [x, y] = SquareOf(point);
    for (int reach = 1; reach <= 2 && least > reach * reach * kPoseSquare * kPoseSquare; ++reach)
      for (int sx = x - reach; sx <= x + reach; ++sx)
        for (int sy = y - reach; sy <= y + reach; ++sy)
          if (const auto found = squares_.find({sx, sy}); found != squares_.end()) look(found->second);
    if (nearest == nullptr) look(poses_);
    return nearest;
  }

  std::vector<const TrajectoryState*> poses_;
  std::map<std::pair<int, int>, std::vector<const TrajectoryState*>> squares_;
};

std::vector<DriveHeight> TieAll(const std::vector<HeightObservation>& heights, const PoseTies& ties) {
  return ParallelMap(heights.size(), [&](size_t i) { return ties.Tie(heights[i]); });
}

/// Where a height lies now. Nothing where the path does not reach its time.
std::optional<Eigen::Vector3d> PointInSite(const DriveHeight& height, const DrivenPath* path) {
  const Eigen::Vector3d point = height.point_in_body.cast<double>();
  if (path == nullptr) return point;
  const std::optional<Rigid3> site_from_body = path->site_from_body.At(height.time);
  if (!site_from_body) return std::nullopt;
  return *site_from_body * point;
}

}  // namespace

DriveHeights MeasureDriveHeights(const PatchSource& patches, const DrivenPath* path, const HeightOptions& options,
                                 std::span<const HeightObservation> measured) {
  DrivenPath leaning = path ? *path : DrivenPath{};
  const DrivenPath* const leaning_path = path ? &leaning : nullptr;
  const auto find_known = [&](const PlaneHeights& planes) {
    std::vector<HeightObservation> known;
    if (path) AddContacts(leaning, options, known);
    const std::vector<HeightObservation> seen = planes.Observations(options.plane_share);
    known.insert(known.end(), seen.begin(), seen.end());
    known.insert(known.end(), measured.begin(), measured.end());
    return known;
  };
  PlaneHeights planes = CollectPlanes(patches, leaning_path, options);
  std::vector<HeightObservation> known = find_known(planes), swept;
  for (int round = 0; path && round < options.sweep.num_rounds; ++round) {
    std::vector<HeightObservation> all = known;
    all.insert(all.end(), swept.begin(), swept.end());
    const HeightField field(std::move(all), options.field);
    const bool is_last = round + 1 == options.sweep.num_rounds;
    swept = MeasureHeights(patches, std::span(path, 1), field, (is_last ? 0.5 : 1.0) * options.sweep.max_offset,
                           options.sweep);
    LogDebug("stage=measure_heights round=" + std::to_string(round) + " heights=" + std::to_string(swept.size()));
    if (round > 0) continue;
    leaning.lean = EstimateLean(leaning, swept);
    leaning.plane_errors = EstimatePlaneErrors(leaning, swept);
    planes = CollectPlanes(patches, leaning_path, options);
    known = find_known(planes);
  }
  if (path)
    LogInfo("stage=measure_heights drive=" + std::to_string(path->drive) + " heights=" + std::to_string(swept.size()) +
            " roll=" + std::to_string(leaning.lean.roll) + " pitch=" + std::to_string(leaning.lean.pitch) +
            " heave=" + std::to_string(leaning.lean.heave) + " plane_errors=" + std::to_string(leaning.plane_errors));
  const PoseTies ties(path);
  return {path ? path->drive : 0, leaning.lean, leaning.plane_errors, TieAll(swept, ties), TieAll(planes.Sums(), ties)};
}

HeightField FitHeights(std::span<const DriveHeights> drives, std::span<const DrivenPath> paths,
                       const HeightOptions& options, std::span<const HeightObservation> measured) {
  std::vector<HeightObservation> heights;
  for (const DrivenPath& path : paths) {
    const auto own = std::find_if(drives.begin(), drives.end(),
                                  [&](const DriveHeights& of_drive) { return of_drive.drive == path.drive; });
    DrivenPath leaning = path;
    if (own != drives.end()) leaning.lean = own->lean;
    AddContacts(leaning, options, heights);
  }
  PlaneHeights planes(options.field);
  std::vector<HeightObservation> swept;
  for (const DriveHeights& of_drive : drives) {
    const DrivenPath* path = FindPath(paths, of_drive.drive);
    for (const DriveHeight& plane : of_drive.planes)
      if (const std::optional<Eigen::Vector3d> point = PointInSite(plane, path)) {
        const double sigma = static_cast<double>(plane.sigma);
        planes.Add(*point, static_cast<double>(plane.weight), 1 / (sigma * sigma));
      }
    for (const DriveHeight& height : of_drive.swept)
      if (const std::optional<Eigen::Vector3d> point = PointInSite(height, path))
        swept.push_back({*point, static_cast<double>(height.weight), static_cast<double>(height.sigma)});
  }
  for (const auto& more : {planes.Observations(options.plane_share), swept})
    heights.insert(heights.end(), more.begin(), more.end());
  heights.insert(heights.end(), measured.begin(), measured.end());
  HeightField field(std::move(heights), options.field);
  SpreadSigmas(field);
  return field;
}

}  // namespace parkade
