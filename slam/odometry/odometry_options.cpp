#include "slam/odometry/odometry_options.h"

#include "core/error.h"

namespace parkade {

void NodeOptions::Validate() const {
  Require(interval >= 0.02 && slow_interval >= interval && still_interval >= interval &&
              distance > 0 && rotation > 0,
          ErrorCode::kUsage,
          "nodes must be at least 0.02 s apart, and further apart when slow or still");
}

void OdometryOptions::Validate() const {
  Require(output_interval > 0 && output_interval <= 0.05, ErrorCode::kUsage,
          "'output_interval' must be in (0, 0.05] s: the trajectory has at least 20 Hz");
  Require(keyframe_distance > 0 && keyframe_rotation_deg > 0, ErrorCode::kUsage,
          "the spacing of keyframes must be positive");
  Require(max_start_time >= 1, ErrorCode::kUsage, "'max_start_time' must be at least 1 s");
  nodes.Validate();
  smoother.Validate();
  standstill.Validate();
  wheels.Validate();
  tracker.Validate();
  cross_camera.Validate();
}

}  // namespace parkade
