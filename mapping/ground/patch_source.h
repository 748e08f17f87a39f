#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "core/ground_patch.h"

namespace parkade {

/// A patch without its samples: who saw it, from where, and how far it reaches.
struct PatchView {
  int drive = 0;
  int camera = 0;
  Timestamp time;
  Rigid3 site_from_body;
  Eigen::AlignedBox2d
      extent;  ///< [m] in site: around all samples where they lie on the car's own plane
};

/// Ground patches with their poses, drive after drive, each in order of time. They may be more than
/// fit into memory: who uses them reads the few that are near.
class PatchSource {
 public:
  virtual ~PatchSource() = default;

  std::span<const PatchView> views() const { return views_; }

  /// The samples of one of the views. Thread-safe.
  virtual PosedGroundPatch Read(std::size_t index) const = 0;

 protected:
  std::vector<PatchView> views_;
};

/// Patches that somebody holds in memory.
class PatchesInMemory final : public PatchSource {
 public:
  /// The patches are borrowed.
  explicit PatchesInMemory(std::span<const PosedGroundPatch> patches);

  PosedGroundPatch Read(std::size_t index) const override { return patches_[index]; }

 private:
  std::span<const PosedGroundPatch> patches_;
};

/// Around the samples of a patch [m]: in body.
Eigen::AlignedBox3d ExtentOf(const GroundPatch& patch);

/// What the box of a patch covers in site.
Eigen::AlignedBox2d ExtentInSite(const Eigen::AlignedBox3d& extent_in_body,
                                 const Rigid3& site_from_body);

}  // namespace parkade
