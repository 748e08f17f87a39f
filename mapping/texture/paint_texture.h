#pragma once

#include <span>

#include "core/drive_log.h"
#include "core/ground_texture.h"
#include "core/option_about.h"
#include "core/surface_map.h"
#include "core/triangle_mesh.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"

namespace parkade {

struct TextureOptions {
  bool enabled = true;       ///< false: vertex colors only
  double texel_size = 0.02;  ///< [m]
  double chart_size = 24;    ///< [m] edge of the squares that have an image each
  double max_range = 14;     ///< [m] from the camera; ground further off keeps its cells' color
  double max_texels = 40e6;  ///< that are painted at once, 24 bytes each; of more ground logs are
                             ///< read several times

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("enabled", enabled, OptionAbout{"The mesh gets a texture from the images."});
    visit("texel_size", texel_size, OptionAbout{"The edge of a texel.", "m", 0.005, 0.5});
    visit("max_range", max_range,
          OptionAbout{"Images show the ground up to this far from the camera.", "m", 2, 40});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// A drive whose images paint. Both borrowed.
struct TextureSource {
  const DriveLog* log = nullptr;
  const DrivenPath* path = nullptr;
};

/// The texture of a mesh from images of the drives over it: every texel is projected into the
/// images that see it from near, all images are brought to one light (CalibratePhotometry), and the
/// steepest observations of the latest drive that agree are blended.
///
/// An image paints no ground that lies behind what it shows to stand there. Among the images of
/// `patches`, only those are decoded that some place needs (ChooseImages), once for their light and
/// once to paint. Logs are read one after the other; a chart takes 24
/// bytes per texel from the first image that shows it to the last, 4 before and after. Where charts
/// have more than `max_texels` they are painted part by part, each from all the logs that show it,
/// and lie on disk once they are done. In parallel over charts, the same every time, whatever the
/// parts.
///
/// \param patches  of images that showed ground, drive by drive, the latest last; those of drives
///                 without a source are not used
/// \param sources  at most one per drive
GroundTexture PaintTexture(const TriangleMesh& mesh, const SurfaceMap& surface,
                           const PatchSource& patches, std::span<const TextureSource> sources,
                           const TextureOptions& options = {});

}  // namespace parkade
