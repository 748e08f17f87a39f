#pragma once

#include <span>

#include "core/drive_log.h"
#include "core/ground_texture.h"
#include "core/surface_map.h"
#include "core/triangle_mesh.h"
#include "mapping/driven_path.h"
#include "mapping/patch_source.h"

namespace parkade {

struct TextureOptions {
  bool enabled = true;       ///< false: vertex colours only
  double texel_size = 0.02;  ///< [m]
  double chart_size = 24;    ///< [m] edge of the squares that have a picture each
  double max_range = 10;     ///< [m] from the camera; ground further off keeps its cells' colour

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("enabled", enabled);
    visit("texel_size", texel_size);
    visit("chart_size", chart_size);
    visit("max_range", max_range);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// A drive whose images paint. Both borrowed.
struct TextureSource {
  const DriveLog* log = nullptr;
  const DrivenPath* path = nullptr;
};

/// The texture of a mesh from images of the drives over it: every texel is projected into the images that see it from
/// near, brightness is made equal to the surface's, and the steepest sights that agree are blended.
///
/// Of the images that `views` name only those are decoded that some place needs (ChoosePhotos). Logs are read one after
/// the other; a chart takes 24 bytes per texel from the first image that shows it to the last, 4 before and after. In
/// parallel over charts, the same every time.
/// \param views    images that showed ground, with their poses; those of drives without a source are not used
/// \param sources  at most one per drive
GroundTexture PaintTexture(const TriangleMesh& mesh, const SurfaceMap& surface, std::span<const PatchView> views,
                           std::span<const TextureSource> sources, const TextureOptions& options = {});

}  // namespace parkade
