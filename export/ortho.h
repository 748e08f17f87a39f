#pragma once

#include <string>

#include "core/ground_texture.h"
#include "core/surface_map.h"
#include "core/triangle_mesh.h"

namespace parkade {

struct Orthophoto {
  std::string png;         ///< 8-bit RGBA, north (site y) up, transparent where nothing was seen
  std::string world_file;  ///< .pgw: metres per pixel and the centre of the upper left pixel in site
};

/// The ground from above; where decks lie above each other, the highest. One pixel per cell, or one per n x n
/// cells where the image would exceed `max_size` pixels a side. Of an empty map one transparent pixel.
Orthophoto RenderOrthophoto(const SurfaceMap& surface, int max_size = 16384);

/// The same from the texture of a mesh: one pixel per texel, or one per n x n. Where decks lie above each other, the
/// chart that lies higher on the whole.
Orthophoto RenderOrthophoto(const TriangleMesh& mesh, const GroundTexture& texture, int max_size = 8192);

}  // namespace parkade
