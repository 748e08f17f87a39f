#include "slam/places/relative_pose.h"

#include "core/error.h"

namespace parkade {

void RelativePoseOptions::Validate() const {
  Require(max_hamming > 0 && max_hamming <= 256 && ratio > 0 && ratio <= 1, ErrorCode::kUsage,
          "max_hamming of relative poses must be 1 to 256 and ratio above 0, at most 1");
  Require(iterations > 0 && max_error > 0 && min_guiding_inliers > 2 && max_tilt_deg > 0 &&
              min_inliers > 2 && min_inliers_of_one > 2 && max_sigma > 0,
          ErrorCode::kUsage,
          "the options of relative poses must be positive, and at least 3 inliers");
  Require(mount_rotation_deg >= 0 && mount_translation >= 0, ErrorCode::kUsage,
          "errors of the mounts must not be negative");
}

}  // namespace parkade
