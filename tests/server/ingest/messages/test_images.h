#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "server/ingest/messages/decoded_image.h"

namespace parkade {

/// Smooth shapes with texture and noise, as a codec meets them.
inline cv::Mat Scene(int seed, int width = 320, int height = 240) {
  cv::Mat image(height, width, CV_8UC3, cv::Scalar(180, 160, 140));
  cv::RNG random(static_cast<std::uint64_t>(seed) + 1);
  for (int i = 0; i < 40; ++i) {
    const cv::Point center(random.uniform(0, width), random.uniform(0, height));
    const cv::Scalar color(random.uniform(0, 255), random.uniform(0, 255), random.uniform(0, 255));
    cv::circle(image, center, random.uniform(5, 50), color, -1);
  }
  cv::GaussianBlur(image, image, {3, 3}, 0);
  cv::Mat noise(image.size(), CV_8UC3);
  random.fill(noise, cv::RNG::NORMAL, 8, 4);
  image += noise;
  return image;
}

inline const ImageRequest kGray{}, kColor{.grayscale = false};

inline double MaxDifference(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return 1e9;
  return cv::norm(a, b, cv::NORM_INF);
}

}  // namespace parkade
