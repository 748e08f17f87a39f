#include "mapping/surface/paint_tile.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/math/fast_floor.h"
#include "mapping/surface/deck_rasters.h"

namespace parkade {
namespace {

using PaintedCell = SurfacePainter::PaintedCell;

constexpr int kPinholeRounds = 3;     // each fills holes of up to about two cells
constexpr int kPinholeNeighbors = 4;  // of 8 that must be seen around a pinhole
constexpr float kDoubtfulBelief =
    0.49F;  // below, something was said: ground that is covered now has no sums
constexpr int kDrivenRounds = 60;  // to fill color in under a car that stood: 3 m at 5 cm

/// Where two surfaces lie too close above each other to be decks, the less certain one is an error.
void DropFalseDecks(double level_separation, std::vector<PaintedCell>& cells) {
  std::vector<PaintedCell> kept;
  kept.reserve(cells.size());
  for (const PaintedCell& cell : cells) {
    const bool is_above =
        !kept.empty() && kept.back().cell.x == cell.cell.x && kept.back().cell.y == cell.cell.y &&
        static_cast<double>(cell.cell.height - kept.back().cell.height) < level_separation;
    if (!is_above)
      kept.push_back(cell);
    else if (cell.is_driven > kept.back().is_driven ||
             (cell.is_driven == kept.back().is_driven &&
              cell.cell.height_sigma < kept.back().cell.height_sigma))
      kept.back() = cell;
  }
  cells = std::move(kept);
}

/// What could not be told from anywhere is as good as unseen, unless something else is known of it.
void ForgetDoubtful(std::vector<PaintedCell>& cells) {
  for (PaintedCell& cell : cells) {
    const bool has_said = cell.observations.free > 0 || cell.observations.occupied > 0 ||
                          cell.cell.free_belief < kDoubtfulBelief;
    if (!cell.is_driven && !has_said) cell.is_seen = false;
  }
}

/// Gives unseen cells the mean of their seen neighbors: single pinholes everywhere, and whatever a
/// car drove on.
void FillPinholes(const SurfaceLinks& links, std::vector<PaintedCell>& cells) {
  std::vector<size_t> unseen;
  for (size_t i = 0; i < cells.size(); ++i)
    if (!cells[i].is_seen) unseen.push_back(i);
  for (int round = 0; round < kDrivenRounds && !unseen.empty(); ++round) {
    std::vector<std::pair<size_t, SurfaceCell>> filled;
    std::vector<size_t> still_unseen;
    for (const size_t i : unseen) {
      std::array<int, 3> color{};
      std::array<int, kNumSurfaceClasses> classes{};
      float belief = 0;
      int count = 0;
      for (const int neighbor : links.Around(static_cast<int>(i))) {
        if (neighbor < 0 || !cells[static_cast<size_t>(neighbor)].is_seen) continue;
        const SurfaceCell& cell = cells[static_cast<size_t>(neighbor)].cell;
        for (size_t c = 0; c < 3; ++c) color[c] += cell.color[c];
        for (size_t c = 0; c < classes.size(); ++c) classes[c] += cell.class_beliefs[c];
        belief += cell.free_belief;
        ++count;
      }
      const bool is_driven = cells[i].is_driven;
      if (count == 0 || (!is_driven && (round >= kPinholeRounds || count < kPinholeNeighbors))) {
        if (is_driven || round + 1 < kPinholeRounds) still_unseen.push_back(i);
        continue;
      }
      SurfaceCell cell = cells[i].cell;
      for (size_t c = 0; c < 3; ++c)
        cell.color[c] = static_cast<std::uint8_t>((color[c] + count / 2) / count);
      for (size_t c = 0; c < classes.size(); ++c)
        cell.class_beliefs[c] = static_cast<std::uint8_t>((classes[c] + count / 2) / count);
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

/// How far cells lie above the road, 0 where that does not reach.
void SetRaised(const HeightField& field, const HeightField& road, double cell_size,
               std::vector<PaintedCell>& cells) {
  constexpr double kSure = 5000;  // [1/m^2]
  for (PaintedCell& painted : cells) {
    const SurfaceCell& cell = painted.cell;
    const Eigen::Vector3d point(cell_size * (cell.x + 0.5), cell_size * (cell.y + 0.5),
                                static_cast<double>(cell.height));
    double level = point.z();
    if (road.FindPatch(point, level) == HeightField::kNone) continue;
    painted.raised = static_cast<float>(point.z() - level);
    const int patch = field.FindPatch(point);
    if (patch == HeightField::kNone) continue;
    const MeasuredHeight& measured = field.MeasuredIn(patch);
    if (!(measured.weight > 0)) continue;
    painted.measured = static_cast<float>(measured.height - level);
    painted.certainty = static_cast<float>(std::sqrt(std::min(1.0, measured.weight / kSure)));
  }
}

/// One drive after the other: where a car drove on an earlier day there may be an obstacle now.
void PaintDrives(const PatchSource& patches, std::span<const DrivenPath> paths,
                 const LatestDrives& latest, SurfacePainter& painter) {
  std::set<int> unseen;
  for (const DrivenPath& path : paths) unseen.insert(path.drive);
  const std::span<const PatchView> views = patches.views();
  for (size_t begin = 0, end = 0; begin < views.size(); begin = end) {
    const int drive = views[begin].drive;
    const DrivenPath* path = FindPath(paths, drive);
    std::vector<size_t> in_reach;
    for (; end < views.size() && views[end].drive == drive; ++end)
      if (const LatestDrives::Share& share = latest.ShareOf(end);
          !share.is_none() && painter.IsInReach(views[end], share.Extent(), path))
        in_reach.push_back(end);
    if (!in_reach.empty()) painter.PaintDrive(patches, in_reach, path, &latest);
    if (path) painter.MarkDriven(*path, &latest);
    unseen.erase(drive);
  }
  for (const int drive : unseen) painter.MarkDriven(*FindPath(paths, drive));
}

}  // namespace

std::vector<FieldTile> CutIntoTiles(const HeightField& field, int cells_per_side,
                                    double tile_size) {
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
    tiles.push_back(
        {{low.matrix(), high.matrix()}, {(low - margin).matrix(), (high + margin).matrix()}});
  }
  return tiles;
}

std::vector<PaintedCell> PaintTile(const FieldTile& tile, const PatchSource& patches,
                                   std::span<const DrivenPath> paths, const LatestDrives& latest,
                                   const HeightField& field, const HeightField& road,
                                   const SurfaceOptions& options, const OutlineNetwork* network) {
  const int cells_per_side =
      static_cast<int>(std::round(options.height.spacing / options.cell_size));
  SurfacePainter painter(field, cells_per_side, tile.window);
  PaintDrives(patches, paths, latest, painter);
  std::vector<PaintedCell> cells = painter.Cells();
  DropFalseDecks(options.height.level_separation, cells);
  SetRaised(field, road, options.cell_size, cells);
  const SurfaceLinks links = LinkPaintedCells(cells, kMaxCellStep);
  if (network)
    network->Refine(links, cells);
  else
    ForgetDoubtful(cells);
  FillPinholes(links, cells);
  const Eigen::Array2i low = tile.core.min().array() * cells_per_side,
                       high = tile.core.max().array() * cells_per_side;
  std::erase_if(cells, [&](const PaintedCell& cell) {
    const Eigen::Array2i at(cell.cell.x, cell.cell.y);
    return !cell.is_seen || (at < low).any() || (at >= high).any();
  });
  return cells;
}

}  // namespace parkade
