#include "mapping/heights/drive_heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <unordered_map>

#include "core/log.h"
#include "core/parallel.h"
#include "mapping/ground/patch_index.h"
#include "mapping/heights/estimate_suspension.h"
#include "mapping/heights/fine_heights.h"
#include "mapping/heights/height_certainty.h"
#include "mapping/heights/measure_heights.h"
#include "mapping/heights/path_agreement.h"
#include "mapping/heights/plane_heights.h"

namespace parkade {
namespace {

constexpr int kNumRounds = 4;  // 0: the height of the ground beside the path is extrapolated only
constexpr double kMaxOffset =
    0.25;  // [m] above and below what is known so far, but for the last round
constexpr double kContactSigma = 0.01;      // [m] of the road's height at a wheel
constexpr double kSuspensionSigma = 0.005;  // [rad] of the body's pitch: adds to the front wheels
constexpr double kPlaneShare =
    0.1;  // weight of a square of a keyframe's plane: those around it err alike
constexpr double kContinuedSigma =
    1;  // [m] of a plane beyond the wheels: how far it holds, SpreadSigmas says
constexpr double kPoseDistance = 0.5;  // [m] between poses that heights may be tied to
constexpr double kPoseSquare = 8.0;    // [m] of the squares in which these are sorted

/// Every third keyframe of each camera: enough to come near the ground, in a third of the time.
class EveryThird final : public PatchSource {
 public:
  /// The source is borrowed. \param which  0 to 2: others
  EveryThird(const PatchSource& source, int which) : source_(&source) {
    std::map<int, int> counts;
    for (std::size_t i = 0; i < source.views().size(); ++i)
      if (counts[source.views()[i].camera]++ % 3 == which) {
        views_.push_back(source.views()[i]);
        indices_.push_back(i);
      }
  }

  PosedGroundPatch Read(std::size_t index) const override { return source_->Read(indices_[index]); }

 private:
  const PatchSource* source_;
  std::vector<std::size_t> indices_;
};

void AddContacts(const DrivenPath& path, const HeightOptions& options,
                 std::vector<HeightObservation>& observations) {
  for (const ContactPoint& contact : FindContacts(path, 0.5 * options.field.spacing)) {
    const double lever = contact.is_front ? path.contact.wheelbase * kSuspensionSigma : 0;
    const double variance = kContactSigma * kContactSigma + lever * lever;
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
      const Eigen::Vector3d& place = state.world_from_body.translation;
      if (last && (place - last->world_from_body.translation).norm() < kPoseDistance) continue;
      last = &state;
      poses_.push_back(&state);
      squares_[SquareOf(place)].push_back(&state);
    }
  }

  DriveHeight Tie(const HeightObservation& height) const {
    DriveHeight tied{{},
                     height.point_in_site.cast<float>(),
                     static_cast<float>(height.weight),
                     static_cast<float>(height.sigma)};
    if (const TrajectoryState* pose = NearestTo(height.point_in_site)) {
      tied.time = pose->time;
      tied.point_in_body = (pose->world_from_body.Inverse() * height.point_in_site).cast<float>();
    }
    return tied;
  }

 private:
  static std::pair<int, int> SquareOf(const Eigen::Vector3d& point) {
    return {static_cast<int>(std::floor(point.x() / kPoseSquare)),
            static_cast<int>(std::floor(point.y() / kPoseSquare))};
  }

  /// Taken from the squares around a point, or from all where these are empty.
  const TrajectoryState* NearestTo(const Eigen::Vector3d& point) const {
    const TrajectoryState* nearest = nullptr;
    double least = std::numeric_limits<double>::max();
    const auto look = [&](const std::vector<const TrajectoryState*>& poses) {
      for (const TrajectoryState* pose : poses) {
        const double distance = (pose->world_from_body.translation - point).squaredNorm();
        if (distance < least) least = distance, nearest = pose;
      }
    };
    const auto [x, y] = SquareOf(point);
    for (int reach = 1; reach <= 2 && least > reach * reach * kPoseSquare * kPoseSquare; ++reach)
      for (int sx = x - reach; sx <= x + reach; ++sx)
        for (int sy = y - reach; sy <= y + reach; ++sy)
          if (const auto found = squares_.find({sx, sy}); found != squares_.end())
            look(found->second);
    if (nearest == nullptr) look(poses_);
    return nearest;
  }

  std::vector<const TrajectoryState*> poses_;
  std::map<std::pair<int, int>, std::vector<const TrajectoryState*>> squares_;
};

std::vector<DriveHeight> TieAll(const std::vector<HeightObservation>& heights,
                                const PoseTies& ties) {
  return ParallelMap(heights.size(), [&](size_t i) { return ties.Tie(heights[i]); });
}

/// The squares of a field in which heights were measured.
class MeasuredSquares {
 public:
  MeasuredSquares(std::span<const HeightObservation> heights, double side)
      : heights_(heights), side_(side) {
    for (const HeightObservation& height : heights)
      index_.Add(Square(height.point_in_site.x()), Square(height.point_in_site.y()));
  }

  bool Has(const Eigen::Vector3d& point) const {
    for (int i = index_.First(Square(point.x()), Square(point.y())); i != PatchIndex::kNone;
         i = index_.Next(i))
      if (std::abs(heights_[static_cast<size_t>(i)].point_in_site.z() - point.z()) < kSameDeck)
        return true;
    return false;
  }

 private:
  static constexpr double kSameDeck = 1.0;  // [m]
  int Square(double coordinate) const { return static_cast<int>(std::floor(coordinate / side_)); }

  std::span<const HeightObservation> heights_;
  double side_;
  PatchIndex index_;
};

/// Where heights of a drive lie now. Many are tied to one pose.
class TiedPoints {
 public:
  explicit TiedPoints(const DrivenPath* path) : path_(path) {}

  /// Nothing where the path does not reach the height's time.
  std::optional<Eigen::Vector3d> InSite(const DriveHeight& height) {
    const Eigen::Vector3d point = height.point_in_body.cast<double>();
    if (path_ == nullptr) return point;
    const auto [found, is_new] = poses_.try_emplace(height.time.ns);
    if (is_new) found->second = path_->site_from_body.At(height.time);
    if (!found->second) return std::nullopt;
    return *found->second * point;
  }

 private:
  const DrivenPath* path_;
  std::unordered_map<std::int64_t, std::optional<Rigid3>> poses_;
};

}  // namespace

DriveHeights MeasureDriveHeights(const PatchSource& patches, const DrivenPath* path,
                                 const HeightOptions& options,
                                 std::span<const HeightObservation> measured) {
  DrivenPath leaning = path ? *path : DrivenPath{};
  const DrivenPath* const leaning_path = path ? &leaning : nullptr;
  const auto find_known = [&](const PlaneHeights& planes) {
    std::vector<HeightObservation> known;
    if (path) AddContacts(leaning, options, known);
    const std::vector<HeightObservation> seen = planes.Observations(kPlaneShare);
    known.insert(known.end(), seen.begin(), seen.end());
    known.insert(known.end(), measured.begin(), measured.end());
    return known;
  };
  const int num_rounds = path ? kNumRounds : 0;
  MeasureHeightsOptions early = options.sweep;
  early.max_views /= 2;
  const std::array<EveryThird, 3> thirds = {EveryThird(patches, 0), EveryThird(patches, 1),
                                            EveryThird(patches, 2)};
  const auto used_in = [&](int round) -> const PatchSource& {
    if (round + 1 >= num_rounds) return patches;
    return thirds[static_cast<size_t>(round) % thirds.size()];
  };
  PlaneHeights planes = CollectPlanes(used_in(0), leaning_path, options.field);
  std::vector<HeightObservation> known = find_known(planes), swept;
  std::optional<HeightField> field;
  for (int round = 0; round < num_rounds; ++round) {
    std::vector<HeightObservation> all = known;
    all.insert(all.end(), swept.begin(), swept.end());
    field = HeightField(std::move(all), options.field, field ? &*field : nullptr);
    const bool is_last = round + 1 == num_rounds;
    swept = is_last ? MeasureFineHeights(patches, std::span(path, 1), *field, options.sweep)
                    : MeasureHeights(used_in(round), std::span(path, 1), *field, kMaxOffset, early);
    LogDebug("stage=measure_heights round=" + std::to_string(round) +
             " heights=" + std::to_string(swept.size()));
    if (round > 0) continue;
    leaning.lean = EstimateSuspension(leaning, swept);
    leaning.plane_errors = EstimatePlaneErrors(leaning, swept);
    planes = CollectPlanes(patches, leaning_path, options.field);
    known = find_known(planes);
  }
  if (path)
    LogInfo("stage=measure_heights drive=" + std::to_string(path->drive) + " heights=" +
            std::to_string(swept.size()) + " roll=" + std::to_string(leaning.lean.roll) +
            " pitch=" + std::to_string(leaning.lean.pitch) +
            " heave=" + std::to_string(leaning.lean.heave) +
            " plane_errors=" + std::to_string(leaning.plane_errors));
  const PoseTies ties(path);
  return {path ? path->drive : 0,
          leaning.lean,
          leaning.plane_errors,
          TieAll(swept, ties),
          TieAll(planes.Sums(), ties),
          path ? SparsePoses(path->site_from_body) : std::vector<TimedPose>()};
}

namespace {

/// What cars stood on.
void AddContactsOf(std::span<const DriveHeights> drives, std::span<const DrivenPath> paths,
                   const HeightOptions& options, std::vector<HeightObservation>& heights) {
  for (const DrivenPath& path : paths) {
    const auto own = std::find_if(drives.begin(), drives.end(), [&](const DriveHeights& of_drive) {
      return of_drive.drive == path.drive;
    });
    DrivenPath leaning = path;
    if (own != drives.end()) leaning.lean = own->lean;
    AddContacts(leaning, options, heights);
  }
}

/// The planes of all keyframes.
std::vector<HeightObservation> PlanesOf(std::span<const DriveHeights> drives,
                                        std::span<const DrivenPath> paths,
                                        const HeightOptions& options) {
  PlaneHeights planes(options.field);
  for (const DriveHeights& of_drive : drives) {
    TiedPoints points(FindPath(paths, of_drive.drive));
    for (const DriveHeight& plane : of_drive.planes)
      if (const std::optional<Eigen::Vector3d> point = points.InSite(plane)) {
        const double sigma = static_cast<double>(plane.sigma);
        planes.Add(*point, static_cast<double>(plane.weight), 1 / (sigma * sigma));
      }
  }
  return planes.Observations(kPlaneShare);
}

}  // namespace

HeightField FitHeights(std::span<const DriveHeights> drives, std::span<const DrivenPath> paths,
                       const HeightOptions& options, std::span<const HeightObservation> measured) {
  std::vector<HeightObservation> heights;
  AddContactsOf(drives, paths, options, heights);
  std::vector<HeightObservation> swept;
  for (const DriveHeights& of_drive : drives) {
    TiedPoints points(FindPath(paths, of_drive.drive));
    for (const DriveHeight& height : of_drive.swept)
      if (const std::optional<Eigen::Vector3d> point = points.InSite(height))
        swept.push_back(
            {*point, static_cast<double>(height.weight), static_cast<double>(height.sigma), true});
  }
  // A keyframe's plane only says how the ground goes on where nothing has measured it.
  const MeasuredSquares measured_at(swept, options.field.spacing);
  for (const HeightObservation& plane : PlanesOf(drives, paths, options))
    if (!measured_at.Has(plane.point_in_site))
      heights.push_back({plane.point_in_site, plane.weight, kContinuedSigma});
  heights.insert(heights.end(), swept.begin(), swept.end());
  heights.insert(heights.end(), measured.begin(), measured.end());
  HeightFieldOptions with_steps = options.field;
  with_steps.has_steps = true;
  HeightField field(heights, with_steps);
  AddScatter(heights, field);
  SpreadSigmas(field);
  return field;
}

HeightField FitRoad(std::span<const DriveHeights> drives, std::span<const DrivenPath> paths,
                    const HeightOptions& options) {
  std::vector<HeightObservation> heights = PlanesOf(drives, paths, options);
  AddContactsOf(drives, paths, options, heights);
  return HeightField(std::move(heights), options.field);
}

}  // namespace parkade
