#pragma once

#include <vector>

#include "slam/refinement/image_residuals.h"
#include "slam/refinement/wheel_slip.h"

namespace parkade {

/// What the measurements of a drive are off its refined trajectory.
struct DriveResiduals {
  std::vector<ImageResidual> images;
  std::vector<WheelSlip> wheels;  ///< while the car moves; empty without wheels
};

}  // namespace parkade
