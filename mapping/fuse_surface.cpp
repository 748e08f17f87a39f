#include "mapping/fuse_surface.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "core/error.h"
#include "core/floor_of.h"
#include "core/log.h"
#include "core/parallel.h"
#include "core/visit_once.h"
#include "mapping/free_islands.h"
#include "mapping/sort_cells.h"
#include "mapping/surface_links.h"
#include "mapping/surface_painter.h"

namespace parkade {
namespace {

using PaintedCell = SurfacePainter::PaintedCell;

constexpr double kMaxCellStep = 0.1;   // [m] of height between neighbouring cells of one deck
constexpr int kPinholeRounds = 3;      // each fills holes of up to about two cells
constexpr int kPinholeNeighbours = 4;  // of 8 that must be seen around a pinhole
constexpr int kDrivenRounds = 60;      // to fill colour in under a car that stood: 3 m at 5 cm

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

/// A square of the site, in squares of the height field.
struct FieldTile {
  Eigen::AlignedBox2i core;    ///< the last square is the one before max()
  Eigen::AlignedBox2i window;  ///< with what pinholes at its rim depend on
};

/// The tiles in which the field has patches, by y, then x.
std::vector<FieldTile> CutIntoTiles(const HeightField& field, int cells_per_side, double tile_size) {
  const int side = std::max(1, static_cast<int>(std::lround(tile_size / field.spacing())));
  const int margin = (kDrivenRounds + 1 + cells_per_side - 1) / cells_per_side;
  std::set<std::pair<int, int>> corners;
  for (int patch = 0; patch < field.num_patches(); ++patch) {
    const Eigen::Vector2i at = field.IndexOf(patch);
    corners.emplace(FloorDivide(at.y(), side), FloorDivide(at.x(), side));
  }
  std::vector<FieldTile> tiles;
  for (const auto& [y, x] : corners) {
    const Eigen::Array2i low = side * Eigen::Array2i(x, y), high = low + side;
    tiles.push_back({{low.matrix(), high.matrix()}, {(low - margin).matrix(), (high + margin).matrix()}});
  }
  return tiles;
}

/// One drive after the other: where a car drove on an earlier day there may be an obstacle now.
void PaintDrives(const PatchSource& patches, std::span<const DrivenPath> paths, const LatestDrives& latest,
                 SurfacePainter& painter) {
  std::set<int> unseen;
  for (const DrivenPath& path : paths) unseen.insert(path.drive);
  const std::span<const PatchView> views = patches.views();
  for (size_t begin = 0, end = 0; begin < views.size(); begin = end) {
    const int drive = views[begin].drive;
    const DrivenPath* path = FindPath(paths, drive);
    std::vector<size_t> in_reach;
    for (; end < views.size() && views[end].drive == drive; ++end)
      if (painter.IsInReach(views[end], path) && !latest.ShareOf(views[end]).is_none()) in_reach.push_back(end);
    if (!in_reach.empty()) painter.PaintDrive(patches, in_reach, path, &latest);
    if (path) painter.MarkDriven(*path);
    unseen.erase(drive);
  }
  for (const int drive : unseen) painter.MarkDriven(*FindPath(paths, drive));
}

/// The finished cells of one tile, but for islands.
std::vector<PaintedCell> PaintTile(const FieldTile& tile, const PatchSource& patches, std::span<const DrivenPath> paths,
                                   const LatestDrives& latest, const HeightField& field,
                                   const SurfaceOptions& options) {
  const int cells_per_side = static_cast<int>(std::round(options.height.spacing / options.cell_size));
  SurfacePainter painter(
      field, cells_per_side,
      {options.free_log_odds, options.occupied_log_odds, options.log_odds_limit, options.change_log_odds}, tile.window);
  PaintDrives(patches, paths, latest, painter);
  std::vector<PaintedCell> cells = painter.Cells();
  DropFalseDecks(options.height.level_separation, cells);
  FillPinholes(LinkCells(SurfaceOf(cells, options.cell_size), kMaxCellStep), cells);
  const Eigen::Array2i low = tile.core.min().array() * cells_per_side, high = tile.core.max().array() * cells_per_side;
  std::erase_if(cells, [&](const PaintedCell& cell) {
    const Eigen::Array2i at(cell.cell.x, cell.cell.y);
    return !cell.is_seen || (at < low).any() || (at >= high).any();
  });
  return cells;
}

/// The cells of the site, row after row, without small islands and without ground whose height is not known.
class CellCollector {
 public:
  CellCollector(const SurfaceOptions& options, size_t max_cells)
      : options_(options), islands_(kMaxCellStep), surface_{options.cell_size, {}} {
    surface_.cells.reserve(max_cells);
    islands_of_.reserve(max_cells);
  }

  /// Whole rows, above all that came before; sorted.
  void Add(std::span<const PaintedCell> cells) {
    for (size_t begin = 0, end = 0; begin < cells.size(); begin = end) {
      for (end = std::min(cells.size(), begin + kMinBatch);
           end < cells.size() && cells[end].cell.y == cells[end - 1].cell.y;)
        ++end;
      AddRows(cells.subspan(begin, end - begin));
    }
    ReleaseMemory(surface_.cells);
    ReleaseMemory(islands_of_);
  }

  SurfaceMap Finish() && {
    const double min_cells = options_.min_island_area / (options_.cell_size * options_.cell_size);
    size_t count = 0;
    const auto keep = [&](size_t i) {
      if (islands_of_[i] == FreeIslands::kNone || !islands_.IsSmall(islands_of_[i], min_cells))
        surface_.cells[count++] = surface_.cells[i];
    };
    VisitOnce(islands_of_, keep, surface_.cells);
    surface_.cells.resize(count);
    return std::move(surface_);
  }

 private:
  static constexpr size_t kMinBatch = 1 << 16;  // cells whose neighbours are looked for at once

  void AddRows(std::span<const PaintedCell> cells) {
    const std::vector<int> islands = islands_.AddRows(cells);
    for (size_t i = 0; i < cells.size(); ++i) {
      const double sigma = static_cast<double>(cells[i].cell.height_sigma);
      if (!cells[i].is_driven && sigma > options_.max_height_sigma) continue;
      surface_.cells.push_back(cells[i].cell);
      islands_of_.push_back(islands[i]);
    }
  }

  const SurfaceOptions& options_;
  FreeIslands islands_;
  SurfaceMap surface_;
  ScratchVector<int> islands_of_;  // as the cells
};

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
  Require(change_log_odds >= 0, ErrorCode::kUsage, "change_log_odds must not be negative");
  Require(max_height_sigma > 0, ErrorCode::kUsage, "max_height_sigma must be > 0 m");
  Require(plane_share > 0 && plane_share <= 1, ErrorCode::kUsage, "plane_share must be in (0, 1]");
  Require(min_island_area >= 0, ErrorCode::kUsage, "min_island_area must not be negative");
  Require(latest_drives >= 1, ErrorCode::kUsage, "latest_drives must be 1 at least");
  Require(tile_size >= height.spacing, ErrorCode::kUsage, "tile_size must be height.spacing at least");
}

SurfaceMap FuseSurface(const PatchSource& patches, std::span<const DrivenPath> paths,
                       std::span<const DriveHeights> heights, const SurfaceOptions& options,
                       std::span<const HeightObservation> measured) {
  options.Validate();
  if (options.method == "homography") return FuseVoxels(patches, paths, options.cell_size, options.voxels);
  const HeightField field = FitHeights(heights, paths, options.Heights(), measured);
  const int cells_per_side = static_cast<int>(std::round(options.height.spacing / options.cell_size));
  const LatestDrives latest(patches.views(), options.latest_drives);
  const auto cells_per_patch = static_cast<size_t>(cells_per_side * cells_per_side);
  CellCollector collector(options, static_cast<size_t>(field.num_patches()) * cells_per_patch);
  const std::vector<FieldTile> tiles = CutIntoTiles(field, cells_per_side, options.tile_size);
  for (size_t begin = 0, end = 0; begin < tiles.size(); begin = end) {
    std::vector<PaintedCell> cells;  // of a row of tiles
    for (; end < tiles.size() && tiles[end].core.min().y() == tiles[begin].core.min().y(); ++end) {
      const std::vector<PaintedCell> of_tile = PaintTile(tiles[end], patches, paths, latest, field, options);
      cells.insert(cells.end(), of_tile.begin(), of_tile.end());
    }
    SortCells(cells);
    collector.Add(cells);
  }
  SurfaceMap surface = std::move(collector).Finish();
  LogInfo("stage=fuse_surface patches=" + std::to_string(patches.views().size()) +
          " nodes=" + std::to_string(field.num_nodes()) + " cells=" + std::to_string(surface.cells.size()));
  return surface;
}

SurfaceMap FuseSurface(std::span<const PosedGroundPatch> patches, std::span<const DrivenPath> paths,
                       const SurfaceOptions& options, std::span<const HeightObservation> measured) {
  options.Validate();
  const PatchesInMemory source(patches);
  std::vector<DriveHeights> heights;
  std::set<int> drives;
  for (const PatchView& view : source.views()) drives.insert(view.drive);
  if (options.method == "surface")
    for (const int drive : drives) {
      heights.push_back(
          MeasureDriveHeights(PatchesOfDrive(source, drive), FindPath(paths, drive), options.Heights(), measured));
      heights.back().drive = drive;
    }
  return FuseSurface(source, paths, heights, options, measured);
}

}  // namespace parkade
