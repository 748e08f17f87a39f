#include "mapping/evaluation/compare_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "core/math/statistics.h"
#include "mapping/evaluation/changed_regions.h"
#include "mapping/evaluation/height_drift.h"
#include "mapping/ground/cell_finder.h"

namespace parkade {
namespace {

constexpr double kSureSigmas = 3;  // of a change

/// What a version says of a cell, from what is surely drivable to what is surely not, or was never
/// seen.
enum class Drivability { kYes, kLikely, kUnlikely, kNo, kUnseen };

Drivability DrivabilityOf(const SurfaceCell* cell, double sure_belief) {
  if (cell == nullptr) return Drivability::kUnseen;
  const double belief = static_cast<double>(cell->free_belief);
  if (belief >= sure_belief) return Drivability::kYes;
  if (belief >= 0.5) return Drivability::kLikely;
  return belief > 1 - sure_belief ? Drivability::kUnlikely : Drivability::kNo;
}

bool IsBefore(const SurfaceCell& a, const SurfaceCell& b) {
  return std::tie(a.y, a.x, a.height) < std::tie(b.y, b.x, b.height);
}

/// Cells by what became of them.
struct Classified {
  std::map<GroundChange, std::vector<ChangedCell>> changed;
  std::vector<SurfaceCell> unchanged;
  std::vector<double> height_changes,
      height_sigmas;  ///< [m] of all ground that is drivable in both
};

class SurfaceComparison {
 public:
  SurfaceComparison(const SurfaceMap& from, const SurfaceMap& to, const SiteMotion& motion,
                    const CompareOptions& options)
      : from_(from),
        to_(to),
        motion_(motion),
        from_cells_(from),
        to_cells_(to),
        options_(options) {}

  Classified Classify() const {
    Classified classified;
    const Rigid3 from_from_to = motion_.to_from_from.Inverse();
    for (const SurfaceCell& cell : to_.cells) {
      const Eigen::Vector3d point = from_from_to * CenterOf(cell, to_.cell_size);
      ClassifyCell(cell, FindOnDeck(from_cells_, point), point.z(), classified);
    }
    ClassifyHeights(classified);
    for (const SurfaceCell& cell : from_.cells) AddUnmapped(cell, classified);
    for (auto& [change, cells] : classified.changed) SortAndMerge(cells);
    return classified;
  }

 private:
  static Eigen::Vector3d CenterOf(const SurfaceCell& cell, double cell_size) {
    return {(cell.x + 0.5) * cell_size, (cell.y + 0.5) * cell_size,
            static_cast<double>(cell.height)};
  }

  const SurfaceCell* FindOnDeck(const CellFinder& cells, const Eigen::Vector3d& point) const {
    const SurfaceCell* found = cells.Find(point);
    if (found == nullptr ||
        std::abs(static_cast<double>(found->height) - point.z()) > options_.level_separation)
      return nullptr;
    return found;
  }

  /// `height_in_from` is where the later version has this ground, seen from the earlier site.
  void ClassifyCell(const SurfaceCell& cell, const SurfaceCell* earlier, double height_in_from,
                    Classified& classified) const {
    const Drivability is = DrivabilityOf(&cell, options_.sure_belief);
    const Drivability was = DrivabilityOf(earlier, options_.sure_belief);
    const auto add = [&](GroundChange change, bool is_obstacle) {
      classified.changed[change].push_back({cell, 0, is_obstacle});
    };
    const auto is_against = [](Drivability found) {
      return found == Drivability::kUnlikely || found == Drivability::kNo;
    };
    if (was == Drivability::kUnseen && is == Drivability::kYes)
      return add(GroundChange::kMapped, false);
    if (is_against(was) && is == Drivability::kYes)
      return add(GroundChange::kFreed, was == Drivability::kNo);
    if (was == Drivability::kYes && is_against(is))
      return add(GroundChange::kBlocked, is == Drivability::kNo);
    if (was != Drivability::kYes || is != Drivability::kYes) return;
    classified.unchanged.push_back(cell);
    classified.height_changes.push_back(height_in_from - static_cast<double>(earlier->height));
    classified.height_sigmas.push_back(std::hypot(static_cast<double>(cell.height_sigma),
                                                  static_cast<double>(earlier->height_sigma),
                                                  motion_.height_sigma));
  }

  /// Takes what was raised or lowered out of what is unchanged.
  void ClassifyHeights(Classified& classified) const {
    const std::vector<SurfaceCell> cells = std::exchange(classified.unchanged, {});
    HeightDrift drift;
    for (size_t i = 0; i < cells.size(); ++i)
      drift.Add(CenterOf(cells[i], to_.cell_size), classified.height_changes[i]);
    drift.Finish();
    for (size_t i = 0; i < cells.size(); ++i) {
      const HeightDrift::Around around = drift.At(CenterOf(cells[i], to_.cell_size));
      const double change = classified.height_changes[i] - around.median;
      const double sigma = std::hypot(classified.height_sigmas[i], around.sigma);
      if (std::abs(change) >= std::max(options_.min_height_change, kSureSigmas * sigma))
        classified.changed[change > 0 ? GroundChange::kRaised : GroundChange::kLowered].push_back(
            {cells[i], change});
      else
        classified.unchanged.push_back(cells[i]);
    }
  }

  void AddUnmapped(const SurfaceCell& cell, Classified& classified) const {
    if (DrivabilityOf(&cell, options_.sure_belief) != Drivability::kYes) return;
    const Eigen::Vector3d point = motion_.to_from_from * CenterOf(cell, from_.cell_size);
    if (FindOnDeck(to_cells_, point) != nullptr) return;
    SurfaceCell moved = cell;
    moved.x = static_cast<int>(std::floor(point.x() / to_.cell_size));
    moved.y = static_cast<int>(std::floor(point.y() / to_.cell_size));
    moved.height = static_cast<float>(point.z());
    classified.changed[GroundChange::kUnmapped].push_back({moved});
  }

  /// Sorted as a SurfaceMap is. Cells of another grid may fall on one of ours twice: the lower one
  /// is kept.
  void SortAndMerge(std::vector<ChangedCell>& cells) const {
    std::sort(cells.begin(), cells.end(),
              [](const ChangedCell& a, const ChangedCell& b) { return IsBefore(a.cell, b.cell); });
    const auto is_same = [&](const ChangedCell& a, const ChangedCell& b) {
      return a.cell.x == b.cell.x && a.cell.y == b.cell.y &&
             static_cast<double>(b.cell.height - a.cell.height) < options_.level_separation;
    };
    cells.erase(std::unique(cells.begin(), cells.end(), is_same), cells.end());
  }

  const SurfaceMap& from_;
  const SurfaceMap& to_;
  SiteMotion motion_;
  CellFinder from_cells_, to_cells_;
  CompareOptions options_;
};

HeightChange Summarize(std::vector<double> changes) {
  HeightChange summary;
  if (changes.empty()) return summary;
  double sum = 0;
  for (const double change : changes) sum += change * change;
  summary.rmse = std::sqrt(sum / static_cast<double>(changes.size()));
  summary.median = Quantile(changes, 0.5);
  for (double& change : changes) change = std::abs(change);
  summary.percentile_95 = Quantile(std::move(changes), 0.95);
  return summary;
}

}  // namespace

void CompareOptions::Validate() const {
  Require(sure_belief > 0.5 && sure_belief < 1, ErrorCode::kUsage,
          "sure_belief must be in (0.5, 1)");
  Require(min_width >= 0 && min_area >= 0 && min_height_change >= 0, ErrorCode::kUsage,
          "min_width, min_area and min_height_change must not be negative");
  Require(level_separation > 0, ErrorCode::kUsage, "level_separation must be > 0 m");
}

SurfaceChanges CompareSurfaces(const SurfaceMap& from, const SurfaceMap& to,
                               const SiteMotion& motion, const CompareOptions& options) {
  options.Validate();
  const Classified classified = SurfaceComparison(from, to, motion, options).Classify();
  SurfaceChanges changes{.cell_size = to.cell_size, .unchanged = classified.unchanged};
  const double min_width = std::max(options.min_width, kSureSigmas * motion.horizontal_sigma);
  const int rounds = static_cast<int>(std::lround(0.5 * min_width / to.cell_size));
  for (const auto& [change, cells] : classified.changed) {
    CellPatches patches(cells, to.cell_size);
    patches.Open(rounds);
    for (const std::vector<size_t>& part : patches.FindParts())
      if (static_cast<double>(part.size()) * to.cell_size * to.cell_size >= options.min_area)
        changes.regions.push_back(patches.RegionOf(change, part));
  }
  std::stable_sort(changes.regions.begin(), changes.regions.end(),
                   [](const ChangedRegion& a, const ChangedRegion& b) {
                     return std::pair(a.change, b.area) < std::pair(b.change, a.area);
                   });
  changes.height = Summarize(classified.height_changes);
  return changes;
}

}  // namespace parkade
