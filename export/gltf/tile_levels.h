#pragma once

#include <functional>
#include <string>

#include "core/ground_texture.h"
#include "core/triangle_mesh.h"

namespace parkade {

/// A part of the map as one level of detail shows it.
struct MapTile {
  int level = 0;             ///< 0 is the finest
  bool is_coarsest = false;  ///< then it is the whole map
  double error = 0;          ///< [m] that its geometry may be off
  int column = 0,
      row = 0;  ///< its square's indices: from the map's lower left corner, in squares of its level
  int layer =
      0;  ///< of the finest level only: counts where decks lie above each other in one square
  std::string name;       ///< begins with a letter, whatever the signs: "at_-1_0"
  TriangleMesh mesh;      ///< empty where nothing is left of it at this level
  GroundTexture texture;  ///< of `mesh`; empty where the map has none
};

/// The map's mesh and texture in levels: the finest cut into the texture's charts, or into squares
/// of `square_size` [m] where there are none; each further level has squares twice as long,
/// vertices merged within cubes twice as large (the first: `coarse_cell` [m]) and texels twice as
/// long, so that images stay of one size; the coarsest is a single tile. At least two levels, none
/// of an empty mesh. Tiles of one level meet without cracks.
///
/// `visit` gets each tile after those that it takes the place of, by row, column, layer: in memory
/// are the images of few tiles of each level.
void VisitTiles(const TriangleMesh& mesh, const GroundTexture& texture, double square_size,
                double coarse_cell, const std::function<void(const MapTile&)>& visit);

}  // namespace parkade
