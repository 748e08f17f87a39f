#pragma once

#include <set>
#include <span>
#include <vector>

#include "mapping/surface/fuse_surface.h"

namespace parkade {

/// Those patches of another source that belong to one drive.
class PatchesOfDrive final : public PatchSource {
 public:
  /// The source is borrowed.
  PatchesOfDrive(const PatchSource& source, int drive) : source_(&source) {
    for (std::size_t i = 0; i < source.views().size(); ++i)
      if (source.views()[i].drive == drive) {
        views_.push_back(source.views()[i]);
        indices_.push_back(i);
      }
  }

  PosedGroundPatch Read(std::size_t index) const override { return source_->Read(indices_[index]); }

 private:
  const PatchSource* source_;
  std::vector<std::size_t> indices_;
};

/// Patches in memory are fused after the heights of each drive were measured.
inline SurfaceMap FuseSurface(std::span<const PosedGroundPatch> patches,
                              std::span<const DrivenPath> paths, const SurfaceOptions& options = {},
                              std::span<const HeightObservation> measured = {}) {
  options.Validate();
  const PatchesInMemory source(patches);
  std::set<int> drives;
  for (const PatchView& view : source.views()) drives.insert(view.drive);
  std::vector<DriveHeights> heights;
  if (options.method == "surface")
    for (const int drive : drives) {
      heights.push_back(MeasureDriveHeights(PatchesOfDrive(source, drive), FindPath(paths, drive),
                                            options.Heights(), measured));
      heights.back().drive = drive;
    }
  return FuseSurface(source, paths, heights, options, measured);
}

}  // namespace parkade
