#pragma once

#include <span>
#include <vector>

#include "core/rig.h"

namespace parkade {

/// Where a camera is mounted, which the refinement of a drive changes, and how its clock and its
/// rows run.
struct CameraPlacement {
  Rigid3 body_from_camera;
  double time_shift = 0;  ///< [s] as of RigCamera
  double line_delay = 0;  ///< [s/row]
};

std::vector<CameraPlacement> PlacementsOf(const Rig& rig);

/// Whether what cameras saw when they were believed to be at `before` still lies where cameras at
/// `now` see it: they turned by 0.3 mrad at most, which lifts what is seen 12 m away by 4 mm and is
/// half of what a refinement knows it to, and lie within 2 mm. Clocks must be the same: by its time
/// an image is found again.
bool SeeAlike(std::span<const CameraPlacement> before, std::span<const CameraPlacement> now);

}  // namespace parkade
