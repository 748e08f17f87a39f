#pragma once

#include <span>

#include "core/drive_log.h"
#include "core/ground_texture.h"
#include "core/surface_map.h"
#include "core/triangle_mesh.h"
#include "mapping/driven_path.h"

namespace parkade {

struct TextureOptions {
  bool enabled = true;               ///< false: vertex colours only
  double texel_size = 0.02;          ///< [m]
  double chart_size = 24;            ///< [m] edge of the squares that have a picture each
  double max_range = 10;             ///< [m] from the camera; ground further off keeps its cells' colour
  double keyframe_distance = 1.0;    ///< [m] of travel between images used of one camera
  double keyframe_angle_deg = 10.0;  ///< or this much turning

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("enabled", enabled);
    visit("texel_size", texel_size);
    visit("chart_size", chart_size);
    visit("max_range", max_range);
    visit("keyframe_distance", keyframe_distance);
    visit("keyframe_angle_deg", keyframe_angle_deg);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// A drive whose images paint. Both borrowed.
struct TextureSource {
  const DriveLog* log = nullptr;
  const DrivenPath* path = nullptr;
};

/// The texture of a mesh from the images of the drives over it: every texel is projected into the images that see it
/// from near, brightness is made equal to the surface's, and the steepest sights that agree are blended. The images
/// are read once more: kept is 16 bytes per texel. In parallel over charts, the same every time.
GroundTexture PaintTexture(const TriangleMesh& mesh, const SurfaceMap& surface, std::span<const TextureSource> sources,
                           const TextureOptions& options = {});

}  // namespace parkade
