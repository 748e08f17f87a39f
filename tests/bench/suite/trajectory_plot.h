#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/trajectory.h"

namespace parkade {

/// A way that was estimated, moved onto the truth.
struct PlottedWay {
  std::string name;
  std::vector<TimedPose> world_from_imu;
};

/// Left: the ways from above, truth in black. Right: distance to the truth over
/// time, horizontally and in height. CV_8UC3, for people.
cv::Mat PlotTrajectories(const std::string& title, const std::vector<TimedPose>& truth,
                         const std::vector<PlottedWay>& ways);

}  // namespace parkade
