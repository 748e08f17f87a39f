#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/camera_model.h"

namespace parkade {

/// The CV_8UC1 version of a CV_8UC1 or CV_8UC3 (BGR) image; empty where it is not of that size and
/// type.
cv::Mat ToGray(const cv::Mat& image, const cv::Size& size);

/// The image with its local mean and contrast made equal everywhere, CV_8UC1:
/// what a lamp, exposure control or vignetting changes slowly over the image
/// does not matter to Lucas-Kanade any more. Contrast below `noise_floor` gray
/// levels is not stretched, so that sensor noise stays small.
cv::Mat NormalizeLocally(const cv::Mat& gray, double noise_floor = 8);

inline constexpr int kPyramidBorder = 32;  ///< [px]

/// The image, half of it, and so on: up to `levels` images of 18 px or more. Beyond its edges each
/// goes on for kPyramidBorder, mirrored.
std::vector<cv::Mat> BuildPyramid(const cv::Mat& gray, int levels);

/// CV_8UC1, 255 where a patch of radius `margin` [px] has a bearing at every
/// pixel, lies in the image and is not touched by `mask` (0 = ignore; may be empty).
cv::Mat UsablePixels(const CameraModel& model, const cv::Mat& mask, int margin);

/// True where the usable part of `gray` holds no structure: a covered lens, a
/// black or white frame.
bool IsBlank(const cv::Mat& gray, const cv::Mat& usable);

}  // namespace parkade
