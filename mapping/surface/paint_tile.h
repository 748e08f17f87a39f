#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "mapping/ground/driven_path.h"
#include "mapping/ground/latest_drives.h"
#include "mapping/ground/patch_source.h"
#include "mapping/heights/height_field.h"
#include "mapping/surface/outline_network.h"
#include "mapping/surface/surface_options.h"
#include "mapping/surface/surface_painter.h"

namespace parkade {

constexpr double kMaxCellStep = 0.1;  ///< [m] of height between neighboring cells of one deck

/// A square of the site, in squares of the height field.
struct FieldTile {
  Eigen::AlignedBox2i core;    ///< the last square is the one before max()
  Eigen::AlignedBox2i window;  ///< with what pinholes at its rim depend on
};

/// The tiles of about `tile_size` [m] in which the field has patches, by y, then x.
std::vector<FieldTile> CutIntoTiles(const HeightField& field, int cells_per_side, double tile_size);

/// The finished cells of one tile, but for islands: painted, one per deck, outlines corrected by
/// `network` where there is one, pinholes filled. Sorted as SurfaceMap. \param road  where the road
/// would go on to (FitRoad)
std::vector<SurfacePainter::PaintedCell> PaintTile(
    const FieldTile& tile, const PatchSource& patches, std::span<const DrivenPath> paths,
    const LatestDrives& latest, const HeightField& field, const HeightField& road,
    const SurfaceOptions& options, const OutlineNetwork* network = nullptr);

}  // namespace parkade
