#include "mapping/ground/patch_source.h"

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

}  // namespace parkade
