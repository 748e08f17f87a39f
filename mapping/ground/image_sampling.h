#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "mapping/ground/wheelbase_footprint.h"

namespace parkade {

/// BGR at a place in a CV_8UC1 or CV_8UC3 image of two columns and rows or more, bilinear; gray
/// three times of CV_8UC1.
inline std::array<float, 3> ColorAt(const cv::Mat& image, float column, float row) {
  const auto channels = static_cast<std::size_t>(image.channels());
  const int x = std::clamp(static_cast<int>(column), 0, image.cols - 2);
  const int y = std::clamp(static_cast<int>(row), 0, image.rows - 2);
  const float fx = column - static_cast<float>(x), fy = row - static_cast<float>(y);
  const std::uint8_t* upper = image.ptr(y) + static_cast<std::size_t>(x) * channels;
  const std::uint8_t* lower = image.ptr(y + 1) + static_cast<std::size_t>(x) * channels;
  std::array<float, 3> color;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t left = channels == 3 ? c : 0, right = left + channels;
    const float above =
        static_cast<float>(upper[left]) * (1 - fx) + static_cast<float>(upper[right]) * fx;
    const float below =
        static_cast<float>(lower[left]) * (1 - fx) + static_cast<float>(lower[right]) * fx;
    color[c] = above * (1 - fy) + below * fy;
  }
  return color;
}

/// Luma as in ITU-R BT.601.
inline int Lightness(int blue, int green, int red) {
  return (29 * blue + 150 * green + 77 * red) >> 8;
}

/// True below a car of known size, body included: what is seen there is the car.
inline bool IsUnderCar(const Eigen::Vector2d& point_in_ground, const WheelbaseFootprint& contact) {
  constexpr double kBodyMargin = 0.4;  // [m] by which a car's body reaches over its contact area
  return contact.wheelbase > 0 && contact.track > 0 &&
         contact.DistanceTo(point_in_ground) < kBodyMargin;
}

}  // namespace parkade
