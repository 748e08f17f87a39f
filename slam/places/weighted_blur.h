#pragma once

#include <opencv2/core/mat.hpp>

namespace parkade {

/// The mean of the values around each pixel, by a Gaussian and by their weights.
///
/// \param values, weights  CV_32FC1 of one size, weights 0 to 1
/// \param sigma            [px]
/// \return CV_32FC1; 0 where nothing around weighs anything
cv::Mat MeanAround(const cv::Mat& values, const cv::Mat& weights, double sigma);

/// The same where WeightsAround of the same weights is known.
cv::Mat MeanAround(const cv::Mat& values, const cv::Mat& weights, const cv::Mat& weights_around,
                   double sigma);

/// The mean of the weights around each pixel, by a Gaussian.
cv::Mat WeightsAround(const cv::Mat& weights, double sigma);

}  // namespace parkade
