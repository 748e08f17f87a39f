#pragma once

#include <opencv2/core/mat.hpp>

namespace parkade::simulator {

/// What arrives behind something on a lens: of the light `transmission` (CV_32FC1, 0 to 1), and of
/// `glow`, which it scatters, the rest. Of `radiance` (CV_32FC3) black, the outside of the lens,
/// stays black.
void CoverLens(const cv::Mat& transmission, const cv::Vec3f& glow, cv::Mat& radiance);

}  // namespace parkade::simulator
