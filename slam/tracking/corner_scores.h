#pragma once

#include <opencv2/core/mat.hpp>

namespace parkade {

inline constexpr int kCornerBlock = 2;  ///< [px] corners are sought on a lattice of this spacing

/// Smaller eigenvalue of the mean structure tensor over 8 x 8 px around each corner of blocks of
/// kCornerBlock [(gray levels / px)^2], CV_32FC1: entry (y, x) is that of pixel (x, y) times
/// kCornerBlock; 0 where the window leaves the image.
///
/// \param image  a level of BuildPyramid, which goes on beyond its edges
cv::Mat CornerScores(const cv::Mat& image);

}  // namespace parkade
