#pragma once

#include "core/ground_texture.h"

namespace parkade {

/// Gives texels that no image shows, kPlain, what their colors are in the mean within a few
/// decimeters, and beside painted ground more and more of its: cells are coarse, and between parked
/// cars they have the colors of these. \param texel_size  [m]
void SmoothPlain(TextureChart& chart, double texel_size);

/// Gives texels off the mesh the color of the nearest one on it: no dark fringe when a viewer
/// interpolates.
void ContinueBeyondBorder(TextureChart& chart);

}  // namespace parkade
