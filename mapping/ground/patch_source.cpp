#include "mapping/ground/patch_source.h"

#include "core/parallel.h"

namespace parkade {

Eigen::AlignedBox3d ExtentOf(const GroundPatch& patch) {
  Eigen::AlignedBox3d extent;
  for (const GroundSample& sample : patch.samples)
    extent.extend(sample.point_in_body.cast<double>());
  return extent;
}

Eigen::AlignedBox2d ExtentInSite(const Eigen::AlignedBox3d& extent_in_body,
                                 const Rigid3& site_from_body) {
  Eigen::AlignedBox2d extent;
  if (extent_in_body.isEmpty()) return extent;
  for (int corner = 0; corner < 8; ++corner)
    extent.extend((site_from_body *
                   extent_in_body.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)))
                      .head<2>());
  return extent;
}

PatchesInMemory::PatchesInMemory(std::span<const PosedGroundPatch> patches) : patches_(patches) {
  for (const PosedGroundPatch& posed : patches)
    views_.push_back({posed.patch.drive, posed.patch.camera, posed.patch.time, posed.site_from_body,
                      ExtentInSite(ExtentOf(posed.patch), posed.site_from_body)});
}

PatchesOfDrive::PatchesOfDrive(const PatchSource& source, int drive) : source_(&source) {
  for (std::size_t i = 0; i < source.views().size(); ++i)
    if (source.views()[i].drive == drive) {
      views_.push_back(source.views()[i]);
      indices_.push_back(i);
    }
}

std::vector<PosedGroundPatch> ReadPatches(const PatchSource& source,
                                          std::span<const std::size_t> indices) {
  return ParallelMap(indices.size(), [&](std::size_t i) { return source.Read(indices[i]); });
}

}  // namespace parkade
