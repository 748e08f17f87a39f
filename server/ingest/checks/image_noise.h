#pragma once

#include <opencv2/core/mat.hpp>

namespace parkade {

/// The standard deviation [gray levels] of an image's noise, in its smoothest parts that are
/// neither black nor white; 0 where there are none, or hardly any image.
///
/// J. Immerkaer, "Fast Noise Variance Estimation", CVIU 1996, by squares of the image, of which the
/// quarter with the least counts: the rest has texture.
///
/// \param image  CV_8UC1
double ImageNoise(const cv::Mat& image);

}  // namespace parkade
