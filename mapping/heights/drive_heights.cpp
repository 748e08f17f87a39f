#include "mapping/heights/drive_heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

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

/// A drive's heights, or those of some squares.
struct HeightsInRounds {
  const PatchSource& patches;
  const DrivenPath* path;
  const HeightOptions& options;
  std::span<const HeightObservation> measured;  ///< that something else knows
  const GroundSquares* only = nullptr;          ///< null: everywhere
  const DriveHeights* before = nullptr;         ///< which tell how the car leans; null: to be found

  DriveHeights Measure() const;
};

DriveHeights HeightsInRounds::Measure() const {
  DrivenPath leaning = path ? *path : DrivenPath{};
  if (before) leaning.lean = before->lean, leaning.plane_errors = before->plane_errors;
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
  PlaneHeights planes = CollectPlanes(before ? patches : used_in(0), leaning_path, options.field);
  std::vector<HeightObservation> known = find_known(planes), swept;
  std::optional<HeightField> field;
  for (int round = 0; round < num_rounds; ++round) {
    std::vector<HeightObservation> all = known;
    all.insert(all.end(), swept.begin(), swept.end());
    field = HeightField(std::move(all), options.field, field ? &*field : nullptr);
    const bool is_last = round + 1 == num_rounds;
    swept = is_last ? MeasureFineHeights(patches, std::span(path, 1), *field, options.sweep, only)
                    : MeasureHeights(used_in(round), std::span(path, 1), *field, kMaxOffset, early,
                                     only);
    LogDebug("stage=measure_heights round=" + std::to_string(round) +
             " heights=" + std::to_string(swept.size()));
    if (round > 0 || before) continue;
    const SuspensionFit fit = EstimateSuspension(leaning, swept);
    leaning.lean = fit.lean, leaning.plane_errors = fit.plane_errors;
    planes = CollectPlanes(patches, leaning_path, options.field);
    known = find_known(planes);
  }
  if (path)
    LogInfo("stage=measure_heights drive=" + std::to_string(path->drive) + " heights=" +
            std::to_string(swept.size()) + " roll=" + std::to_string(leaning.lean.roll) +
            " pitch=" + std::to_string(leaning.lean.pitch) +
            " heave=" + std::to_string(leaning.lean.heave) +
            " plane_errors=" + std::to_string(leaning.plane_errors));
  const PoseTies ties(path ? &path->site_from_body : nullptr);
  return {path ? path->drive : 0,
          leaning.lean,
          leaning.plane_errors,
          TieAll(swept, ties),
          TieAll(planes.Sums(), ties),
          path ? std::vector{HeightsAlong{SparsePoses(path->site_from_body), swept.size()}}
               : std::vector<HeightsAlong>()};
}

HeightObservation At(const Eigen::Vector3d& point, const DriveHeight& height) {
  return {point, static_cast<double>(height.weight), static_cast<double>(height.sigma)};
}

}  // namespace

DriveHeights MeasureDriveHeights(const PatchSource& patches, const DrivenPath* path,
                                 const HeightOptions& options,
                                 std::span<const HeightObservation> measured) {
  return HeightsInRounds{patches, path, options, measured}.Measure();
}

DriveHeights MeasureMovedHeights(const PatchSource& patches, const DrivenPath& path,
                                 const HeightOptions& options, const DriveHeights& before,
                                 const GroundSquares& squares) {
  std::vector<HeightObservation> measured;
  std::vector<DriveHeight> kept;
  std::vector<HeightsAlong> along;
  TiedPoints points(&path.site_from_body);
  auto next = before.swept.begin();
  for (const HeightsAlong& earlier : before.along) {
    along.push_back({earlier.path, 0});
    for (std::uint64_t i = 0; i < earlier.num_swept; ++i, ++next) {
      const std::optional<Eigen::Vector3d> point = points.InSite(*next);
      if (!point || squares.Has(*point)) continue;
      measured.push_back(At(*point, *next));
      kept.push_back(*next);
      ++along.back().num_swept;
    }
    if (along.back().num_swept == 0) along.pop_back();
  }
  DriveHeights heights =
      HeightsInRounds{patches, &path, options, measured, &squares, &before}.Measure();
  heights.swept.insert(heights.swept.begin(), kept.begin(), kept.end());
  heights.along.insert(heights.along.begin(), along.begin(), along.end());
  return heights;
}

namespace {

const Trajectory* TrajectoryOf(std::span<const DrivenPath> paths, int drive) {
  const DrivenPath* path = FindPath(paths, drive);
  return path ? &path->site_from_body : nullptr;
}

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
    TiedPoints points(TrajectoryOf(paths, of_drive.drive));
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
    TiedPoints points(TrajectoryOf(paths, of_drive.drive));
    for (const DriveHeight& height : of_drive.swept)
      if (const std::optional<Eigen::Vector3d> point = points.InSite(height)) {
        swept.push_back(At(*point, height));
        swept.back().is_swept = true;
      }
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
