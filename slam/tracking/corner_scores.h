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

/// Which scores are at least `least`, and no lower than the eight around them: CV_8UC1, not 0
/// there. The first of equal neighbors in reading order is it. Entries at the edge are not.
cv::Mat FindPeaks(const cv::Mat& scores, float least);

}  // namespace parkade
