#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <opencv2/core/mat.hpp>

#include "mapping/ground/wheelbase_footprint.h"

namespace parkade {

/// Four bytes of memory as floats.
using FourFloats = float __attribute__((vector_size(16)));
inline FourFloats FloatsAt(const std::uint8_t* bytes) {
  using FourBytes = std::uint8_t __attribute__((vector_size(4)));
  FourBytes values;
  std::memcpy(&values, bytes, sizeof(values));
  return __builtin_convertvector(values, FourFloats);
}

/// The channels of the pixel behind one of three; the fourth float is the last of them again.
inline FourFloats RightOf(const std::uint8_t* pixel) {
  // From a byte earlier on: the one behind it may lie off the image.
  const FourFloats last_and_right = FloatsAt(pixel + 2);
  return __builtin_shufflevector(last_and_right, last_and_right, 1, 2, 3, 3);
}

/// BGR at a place of a CV_8UC1 or CV_8UC3 image, bilinear; gray three times of CV_8UC1. Places off
/// the image take its border.
inline std::array<float, 3> ColorAt(const cv::Mat& image, float column, float row) {
  const int x = std::clamp(static_cast<int>(column), 0, image.cols - 2);
  const int y = std::clamp(static_cast<int>(row), 0, image.rows - 2);
  const float fx = column - static_cast<float>(x), fy = row - static_cast<float>(y);
  const auto mean = [=](auto upper_left, auto upper_right, auto lower_left, auto lower_right) {
    return (upper_left * (1 - fx) + upper_right * fx) * (1 - fy) +
           (lower_left * (1 - fx) + lower_right * fx) * fy;
  };
  if (image.channels() == 1) {
    const std::uint8_t *upper = image.ptr(y) + x, *lower = image.ptr(y + 1) + x;
    const auto gray_at = [](std::uint8_t gray) { return static_cast<float>(gray); };
    const float gray =
        mean(gray_at(upper[0]), gray_at(upper[1]), gray_at(lower[0]), gray_at(lower[1]));
    return {gray, gray, gray};
  }
  const std::uint8_t *upper = image.ptr(y) + std::ptrdiff_t{3} * x,
                     *lower = image.ptr(y + 1) + std::ptrdiff_t{3} * x;
  const FourFloats color = mean(FloatsAt(upper), RightOf(upper), FloatsAt(lower), RightOf(lower));
  return {color[0], color[1], color[2]};
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
