#pragma once

#include <functional>
#include <string>

#include "core/site_map.h"

namespace parkade {

struct TileOptions {
  double tile_size = 32;  ///< [m] edge of the square that a full-resolution tile covers; a
                          ///< texture's charts take their place
  double coarse_cell =
      0.5;  ///< [m] vertices of the first coarser level are merged within cubes of this edge
};

/// 3D Tiles 1.1 of the map's mesh: a quadtree of levels of detail (VisitTiles), the coarsest being
/// one tile, each replaced from near by finer ones. The root's transform puts the site on the
/// ellipsoid where there is a datum. Tiles are .glb with Draco; neighbors of one level meet without
/// cracks. Gives each file's path ("tileset.json", "tiles/...") and bytes to `write`.
void EncodeTiles(
    const SiteMap& map,
    const std::function<void(const std::string& path, const std::string& bytes)>& write,
    const TileOptions& options = {});

}  // namespace parkade
