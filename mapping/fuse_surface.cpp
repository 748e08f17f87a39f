#include "mapping/fuse_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "mapping/estimate_lean.h"
#include "mapping/height_certainty.h"
#include "mapping/surface_links.h"
#include "mapping/surface_painter.h"

namespace parkade {
namespace {

using PaintedCell = SurfacePainter::PaintedCell;

constexpr double kLeastPlaneVariance = 4e-4;  // [m^2] of a keyframe's plane: wheels and the sweep are surer
constexpr double kMaxCellStep = 0.1;          // [m] of height between neighbouring cells of one deck
constexpr int kPinholeRounds = 3;             // each fills holes of up to about two cells
constexpr int kPinholeNeighbours = 4;         // of 8 that must be seen around a pinhole
constexpr int kDrivenRounds = 60;             // to fill colour in under a car that stood: 3 m at 5 cm

/// The heights at which patches put the ground: the planes that their cars stood on.
class PlaneHeights {
 public:
  explicit PlaneHeights(const HeightFieldOptions& options = {}, double share = 1) : options_(options), share_(share) {}

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
      const auto index = [](double value, double step) { return static_cast<int>(std::floor(value / step)); };
      Sum& sum = sums_[{index(point.z(), options_.level_separation), index(point.y(), options_.spacing),
                        index(point.x(), options_.spacing)}];
      const double weight = 1 / (share / static_cast<double>(sample.weight) + kLeastPlaneVariance);
      sum.point += weight * point;
      sum.weight += weight;
      sum.best_weight = std::max(sum.best_weight, weight);
    }
  }

  /// One per square and deck: planes share their errors, so that many say hardly more than the best of them.
  std::vector<HeightObservation> Observations() const {
    std::vector<HeightObservation> observations;
    observations.reserve(sums_.size());
    for (const auto& [square, sum] : sums_) observations.push_back({sum.point / sum.weight, share_ * sum.best_weight});
    return observations;
  }

  void Merge(const PlaneHeights& other) {
    for (const auto& [square, sum] : other.sums_) {
      Sum& here = sums_[square];
      here.point += sum.point;
      here.weight += sum.weight;
      here.best_weight = std::max(here.best_weight, sum.best_weight);
    }
  }

 private:
  struct Sum {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double weight = 0, best_weight = 0;
  };
  HeightFieldOptions options_;
  double share_ = 1;  ///< of an observation of its own
  std::map<std::tuple<int, int, int>, Sum> sums_;
};

std::vector<HeightObservation> CollectHeights(std::span<const PosedGroundPatch> patches,
                                              std::span<const DrivenPath> paths, const SurfaceOptions& options) {
  std::vector<HeightObservation> observations;
  for (const DrivenPath& path : paths)
    for (const ContactPoint& contact : FindContacts(path, 0.5 * options.height.spacing)) {
      const double lever = contact.is_front ? path.contact.wheelbase * options.suspension_sigma : 0;
      const double variance = options.contact_sigma * options.contact_sigma + lever * lever;
      observations.push_back({contact.point_in_site, 1 / variance});
    }
  const auto of_patches = ParallelMap(patches.size(), [&](size_t i) {
    PlaneHeights heights(options.height);
    heights.Add(patches[i], FindPath(paths, patches[i].patch.drive));
    return heights;
  });
  PlaneHeights planes(options.height, options.plane_share);
  for (const PlaneHeights& heights : of_patches) planes.Merge(heights);
  const std::vector<HeightObservation> seen = planes.Observations();
  observations.insert(observations.end(), seen.begin(), seen.end());
  return observations;
}

void LogLean(const std::vector<DrivenPath>& paths) {
  for (const DrivenPath& path : paths)
    LogInfo("stage=lean drive=" + std::to_string(path.drive) + " roll=" + std::to_string(path.lean.roll) +
            " pitch=" + std::to_string(path.lean.pitch) + " heave=" + std::to_string(path.lean.heave) +
            " plane_errors=" + std::to_string(path.plane_errors));
}

/// Heights from all there is. Each round of the sweep starts from what the last one found, so that what is known of the
/// ground grows outwards from the path. The first one also tells how the cars lean.
HeightField FitHeights(std::span<const PosedGroundPatch> patches, std::span<const DrivenPath> paths,
                       const SurfaceOptions& options, std::span<const HeightObservation> measured) {
  std::vector<DrivenPath> leaning(paths.begin(), paths.end());
  std::vector<HeightObservation> known = CollectHeights(patches, leaning, options);
  known.insert(known.end(), measured.begin(), measured.end());
  HeightField field(known, options.height);
  for (int round = 0; round < options.sweep.num_rounds; ++round) {
    const bool is_last = round + 1 == options.sweep.num_rounds;
    const std::vector<HeightObservation> swept =
        MeasureHeights(patches, paths, field, (is_last ? 0.5 : 1.0) * options.sweep.max_offset, options.sweep);
    LogDebug("stage=measure_heights round=" + std::to_string(round) + " heights=" + std::to_string(swept.size()));
    if (round == 0) {
      for (DrivenPath& path : leaning) {
        path.lean = EstimateLean(path, swept);
        path.plane_errors = EstimatePlaneErrors(path, swept);
      }
      LogLean(leaning);
      known = CollectHeights(patches, leaning, options);
      known.insert(known.end(), measured.begin(), measured.end());
    }
    std::vector<HeightObservation> all = known;
    all.insert(all.end(), swept.begin(), swept.end());
    field = HeightField(std::move(all), options.height);
  }
  SpreadSigmas(field);
  return field;
}

/// One drive after the other: where a car drove on an earlier day there may be an obstacle now.
void PaintDrives(std::span<const PosedGroundPatch> patches, std::span<const DrivenPath> paths,
                 SurfacePainter& painter) {
  std::set<int> unseen;
  for (const DrivenPath& path : paths) unseen.insert(path.drive);
  for (size_t begin = 0, end = 0; begin < patches.size(); begin = end) {
    const int drive = patches[begin].patch.drive;
    while (end < patches.size() && patches[end].patch.drive == drive) ++end;
    painter.PaintDrive(patches.subspan(begin, end - begin), paths);
    if (const DrivenPath* path = FindPath(paths, drive)) painter.MarkDriven(*path);
    unseen.erase(drive);
  }
  for (const int drive : unseen) painter.MarkDriven(*FindPath(paths, drive));
}

SurfaceMap SurfaceOf(const std::vector<PaintedCell>& cells, double cell_size) {
  SurfaceMap surface{cell_size, {}};
  surface.cells.reserve(cells.size());
  for (const PaintedCell& cell : cells) surface.cells.push_back(cell.cell);
  return surface;
}

/// Where two surfaces lie too close above each other to be decks, the less certain one is an error.
void DropFalseDecks(double level_separation, std::vector<PaintedCell>& cells) {
  std::vector<PaintedCell> kept;
  kept.reserve(cells.size());
  for (const PaintedCell& cell : cells) {
    const bool is_above = !kept.empty() && kept.back().cell.x == cell.cell.x && kept.back().cell.y == cell.cell.y &&
                          static_cast<double>(cell.cell.height - kept.back().cell.height) < level_separation;
    if (!is_above)
      kept.push_back(cell);
    else if (cell.is_driven > kept.back().is_driven ||
             (cell.is_driven == kept.back().is_driven && cell.cell.height_sigma < kept.back().cell.height_sigma))
      kept.back() = cell;
  }
  cells = std::move(kept);
}

/// Gives unseen cells the mean of their seen neighbours: single pinholes everywhere, and whatever a car drove on.
void FillPinholes(const SurfaceLinks& links, std::vector<PaintedCell>& cells) {
  std::vector<size_t> unseen;
  for (size_t i = 0; i < cells.size(); ++i)
    if (!cells[i].is_seen) unseen.push_back(i);
  for (int round = 0; round < kDrivenRounds && !unseen.empty(); ++round) {
    std::vector<std::pair<size_t, SurfaceCell>> filled;
    std::vector<size_t> still_unseen;
    for (const size_t i : unseen) {
      std::array<int, 3> color{};
      float belief = 0;
      int count = 0;
      for (const int neighbour : links.Around(static_cast<int>(i))) {
        if (neighbour < 0 || !cells[static_cast<size_t>(neighbour)].is_seen) continue;
        const SurfaceCell& cell = cells[static_cast<size_t>(neighbour)].cell;
        for (size_t c = 0; c < 3; ++c) color[c] += cell.color[c];
        belief += cell.free_belief;
        ++count;
      }
      const bool is_driven = cells[i].is_driven;
      if (count == 0 || (!is_driven && (round >= kPinholeRounds || count < kPinholeNeighbours))) {
        if (is_driven || round + 1 < kPinholeRounds) still_unseen.push_back(i);
        continue;
      }
      SurfaceCell cell = cells[i].cell;
      for (size_t c = 0; c < 3; ++c) cell.color[c] = static_cast<std::uint8_t>((color[c] + count / 2) / count);
      if (!is_driven) cell.free_belief = belief / static_cast<float>(count);
      filled.emplace_back(i, cell);
    }
    for (const auto& [i, cell] : filled) {
      cells[i].cell = cell;
      cells[i].is_seen = true;
    }
    if (filled.empty() && round >= kPinholeRounds) break;
    unseen = std::move(still_unseen);
  }
}

/// Cells of free islands that are small and that no car drove on.
std::vector<bool> FindSmallIslands(const std::vector<PaintedCell>& cells, const SurfaceLinks& links, double min_cells) {
  std::vector<int> root(cells.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int i) {
    while (root[static_cast<size_t>(i)] != i)
      i = root[static_cast<size_t>(i)] = root[static_cast<size_t>(root[static_cast<size_t>(i)])];
    return i;
  };
  const auto is_free = [&](size_t i) { return cells[i].is_seen && cells[i].cell.free_belief > 0.5F; };
  for (size_t i = 0; i < cells.size(); ++i)
    for (const int next : {links.right[i], links.up[i]}) {
      if (next < 0 || !is_free(i) || !is_free(static_cast<size_t>(next))) continue;
      const int a = find(static_cast<int>(i)), b = find(next);
      root[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
    }
  std::vector<int> size(cells.size());
  std::vector<bool> is_driven(cells.size());
  for (size_t i = 0; i < cells.size(); ++i) {
    const auto island = static_cast<size_t>(find(static_cast<int>(i)));
    ++size[island];
    if (cells[i].is_driven) is_driven[island] = true;
  }
  std::vector<bool> is_small(cells.size());
  for (size_t i = 0; i < cells.size(); ++i) {
    const auto island = static_cast<size_t>(find(static_cast<int>(i)));
    is_small[i] = is_free(i) && !is_driven[island] && size[island] < min_cells;
  }
  return is_small;
}

}  // namespace

void SurfaceOptions::Validate() const {
  Require(cell_size > 0, ErrorCode::kUsage, "cell_size must be > 0 m");
  Require(method == "surface" || method == "homography", ErrorCode::kUsage,
          "method of the surface must be surface or homography");
  height.Validate();
  voxels.Validate();
  sweep.Validate();
  const double ratio = height.spacing / cell_size;
  Require(ratio >= 1 && std::abs(ratio - std::round(ratio)) < 1e-6, ErrorCode::kUsage,
          "height.spacing must be a multiple of cell_size");
  Require(contact_sigma > 0 && suspension_sigma >= 0, ErrorCode::kUsage,
          "contact_sigma must be > 0 m and suspension_sigma not negative");
  Require(free_log_odds > 0 && occupied_log_odds > 0 && log_odds_limit > std::max(free_log_odds, occupied_log_odds),
          ErrorCode::kUsage, "free_log_odds and occupied_log_odds must be in (0, log_odds_limit)");
  Require(max_height_sigma > 0, ErrorCode::kUsage, "max_height_sigma must be > 0 m");
  Require(plane_share > 0 && plane_share <= 1, ErrorCode::kUsage, "plane_share must be in (0, 1]");
  Require(min_island_area >= 0, ErrorCode::kUsage, "min_island_area must not be negative");
}

SurfaceMap FuseSurface(std::span<const PosedGroundPatch> patches, std::span<const DrivenPath> paths,
                       const SurfaceOptions& options, std::span<const HeightObservation> measured) {
  options.Validate();
  if (options.method == "homography") return FuseVoxels(patches, paths, options.cell_size, options.voxels);
  const HeightField field = FitHeights(patches, paths, options, measured);
  SurfacePainter painter(field, static_cast<int>(std::round(options.height.spacing / options.cell_size)),
                         {options.free_log_odds, options.occupied_log_odds, options.log_odds_limit});
  PaintDrives(patches, paths, painter);

  std::vector<PaintedCell> cells = painter.Cells();
  DropFalseDecks(options.height.level_separation, cells);
  const SurfaceLinks links = LinkCells(SurfaceOf(cells, options.cell_size), kMaxCellStep);
  FillPinholes(links, cells);
  const std::vector<bool> is_small =
      FindSmallIslands(cells, links, options.min_island_area / (options.cell_size * options.cell_size));
  SurfaceMap surface{options.cell_size, {}};
  for (size_t i = 0; i < cells.size(); ++i)
    if (cells[i].is_seen && !is_small[i] &&
        (cells[i].is_driven || static_cast<double>(cells[i].cell.height_sigma) <= options.max_height_sigma))
      surface.cells.push_back(cells[i].cell);
  LogInfo("stage=fuse_surface patches=" + std::to_string(patches.size()) +
          " nodes=" + std::to_string(field.num_nodes()) + " cells=" + std::to_string(surface.cells.size()));
  return surface;
}

}  // namespace parkade
