#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

#include "core/geo.h"
#include "core/ground_texture.h"
#include "core/surface_map.h"
#include "core/triangle_mesh.h"

namespace parkade {

/// The ground from above, north (site y) up.
struct Orthophoto {
  cv::Mat image;             ///< CV_8UC4 (BGRA), transparent where nothing was seen
  double pixel_size = 0;     ///< [m]
  double left = 0, top = 0;  ///< [m] in site, of the outer corner of the upper left pixel
};

/// Draws the highest deck where several lie above each other. One pixel per cell, or one per n x n
/// cells where the image would exceed `max_size` pixels a side. An empty map gives one transparent
/// pixel.
Orthophoto RenderOrthophoto(const SurfaceMap& surface, int max_size = 16384);

/// Draws the texture of a mesh: one pixel per texel, or one per n x n. Where decks lie above each
/// other, the chart that lies higher on the whole is shown.
Orthophoto RenderOrthophoto(const TriangleMesh& mesh, const GroundTexture& texture,
                            int max_size = 8192);

/// Encodes an 8-bit RGBA PNG.
std::string EncodePng(const Orthophoto& ortho);

/// The orthophoto's .pgw: meters per pixel and the center of the upper left pixel in site.
std::string EncodeWorldFile(const Orthophoto& ortho);

/// The orthophoto on Earth: a tiled, deflated RGBA GeoTIFF 1.1 (OGC 19-008) in a transverse
/// Mercator projection about the datum, scaled to its height: within a kilometer of it the same as
/// the site's tangent plane to millimeters.
std::string EncodeGeoTiff(const Orthophoto& ortho, const SiteDatum& datum);

}  // namespace parkade
