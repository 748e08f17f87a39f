#include "mapping/surface/fuse_surface.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/files/for_each_releasing.h"
#include "core/log.h"
#include "core/parallel.h"
#include "mapping/baselines/fuse_voxels.h"
#include "mapping/ground/sort_cells.h"
#include "mapping/surface/free_islands.h"
#include "mapping/surface/paint_tile.h"

namespace parkade {
namespace {

using PaintedCell = SurfacePainter::PaintedCell;

constexpr size_t kTilesAtOnce =
    2;  // one is finished on few threads while the next is painted on many

/// The cells of the site, row after row, without small islands and without ground whose height is
/// not known.
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
    ForEachReleasing(islands_of_, keep, surface_.cells);
    surface_.cells.resize(count);
    return std::move(surface_);
  }

 private:
  static constexpr size_t kMinBatch = 1 << 16;  // cells whose neighbors are looked for at once

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
  FileBackedVector<int> islands_of_;  // as the cells
};

}  // namespace

SurfaceMap FuseSurface(const PatchSource& patches, std::span<const DrivenPath> paths,
                       std::span<const DriveHeights> heights, const SurfaceOptions& options,
                       std::span<const HeightObservation> measured) {
  options.Validate();
  if (options.method == "homography") return FuseVoxels(patches, paths, options.cell_size);
  const HeightField field = FitHeights(heights, paths, options.Heights(), measured);
  const HeightField road = FitRoad(heights, paths, options.Heights());
  const int cells_per_side =
      static_cast<int>(std::round(options.height.spacing / options.cell_size));
  const LatestDrives latest(patches.views(), options.latest_drives);
  const auto cells_per_patch = static_cast<size_t>(cells_per_side * cells_per_side);
  CellCollector collector(options, static_cast<size_t>(field.num_patches()) * cells_per_patch);
  std::optional<OutlineNetwork> network;
  if (options.outlines == "network") network.emplace();
  const std::vector<FieldTile> tiles = CutIntoTiles(field, cells_per_side, options.tile_size);
  for (size_t begin = 0, end = 0; begin < tiles.size(); begin = end) {
    while (end < tiles.size() && tiles[end].core.min().y() == tiles[begin].core.min().y()) ++end;
    std::vector<PaintedCell> cells;  // of a row of tiles
    for (size_t first = begin; first < end; first += kTilesAtOnce) {
      const auto of_tiles = ParallelMap(std::min(kTilesAtOnce, end - first), [&](size_t i) {
        return PaintTile(tiles[first + i], patches, paths, latest, field, road, options,
                         network ? &*network : nullptr);
      });
      for (const auto& of_tile : of_tiles)
        cells.insert(cells.end(), of_tile.begin(), of_tile.end());
    }
    SortCells(cells);
    collector.Add(cells);
  }
  SurfaceMap surface = std::move(collector).Finish();
  LogInfo("stage=fuse_surface patches=" + std::to_string(patches.views().size()) + " nodes=" +
          std::to_string(field.num_nodes()) + " cells=" + std::to_string(surface.cells.size()));
  return surface;
}

}  // namespace parkade
