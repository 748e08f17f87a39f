#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <opencv2/core/mat.hpp>

namespace parkade {

/// The same for a grid whose steps are pixels: all samples share their weights.
template <int kEdge>
void SampleUprightGrid(const cv::Mat& image, const Eigen::Vector2d& first,
                       Eigen::Matrix<float, kEdge, kEdge>& samples) {
  const int x = static_cast<int>(first.x()), y = static_cast<int>(first.y());
  const auto u = static_cast<float>(first.x() - x), v = static_cast<float>(first.y() - y);
  float above[kEdge], below[kEdge];
  const auto fill = [&](int row, float* values) {
    const std::uint8_t* pixels = image.ptr<std::uint8_t>(y + row) + x;
    for (int i = 0; i < kEdge; ++i)
      values[i] = static_cast<float>(pixels[i]) + u * static_cast<float>(pixels[i + 1] - pixels[i]);
  };
  fill(0, above);
  for (int row = 0; row < kEdge; ++row) {
    fill(row + 1, below);
    for (int i = 0; i < kEdge; ++i) {
      samples(row, i) = above[i] + v * (below[i] - above[i]);
      above[i] = below[i];
    }
  }
}

/// Where the samples of a grid's column lie, and the pixels around them.
template <int kEdge>
struct GridColumn {
  static constexpr int kSize = (kEdge + 3) / 4 * 4;  // whole vectors

  std::array<float, kSize> u{}, v{};                  ///< [px] from the pixel up and left
  std::array<std::int32_t, kSize> x{}, y{};           ///< [px] of that
  std::array<std::uint16_t, kSize> upper{}, lower{};  ///< it, its right neighbor times 256; below
};

/// The same for any grid that is in the image. Loops are such that the compiler makes vectors of
/// all but the reading.
template <int kEdge>
void SampleTurnedGrid(const cv::Mat& image, const Eigen::Vector2d& center,
                      const Eigen::Matrix2d& image_from_grid,
                      Eigen::Matrix<float, kEdge, kEdge>& samples) {
  static_assert(std::endian::native == std::endian::little);
  using Column = GridColumn<kEdge>;
  constexpr double kHalf = 0.5 * (kEdge - 1);
  const Eigen::Vector2f right = image_from_grid.col(0).cast<float>();
  const Eigen::Vector2f down = image_from_grid.col(1).cast<float>();
  const Eigen::Vector2f first =
      (center - kHalf * (image_from_grid.col(0) + image_from_grid.col(1))).cast<float>();
  std::array<float, Column::kSize> left_x, left_y, values;
  for (size_t i = 0; i < left_x.size(); ++i) {
    left_x[i] = first.x() + static_cast<float>(i) * down.x();
    left_y[i] = first.y() + static_cast<float>(i) * down.y();
  }
  Column at;
  for (int column = 0; column < kEdge; ++column) {
    const Eigen::Vector2f step = static_cast<float>(column) * right;
    for (size_t i = 0; i < Column::kSize; ++i) {
      const float x = std::max(left_x[i] + step.x(), 0.0f);
      const float y = std::max(left_y[i] + step.y(), 0.0f);
      at.x[i] = static_cast<std::int32_t>(x);
      at.y[i] = static_cast<std::int32_t>(y);
      at.u[i] = x - static_cast<float>(at.x[i]);
      at.v[i] = y - static_cast<float>(at.y[i]);
    }
    for (size_t i = 0; i < kEdge; ++i) {
      const std::uint8_t* pixel = image.ptr<std::uint8_t>(at.y[i]) + at.x[i];
      std::memcpy(&at.upper[i], pixel, 2);
      std::memcpy(&at.lower[i], pixel + image.step[0], 2);
    }
    for (size_t i = 0; i < Column::kSize; ++i) {
      const int upper = at.upper[i] & 255, lower = at.lower[i] & 255;
      const float top =
          static_cast<float>(upper) + at.u[i] * static_cast<float>((at.upper[i] >> 8) - upper);
      const float bottom =
          static_cast<float>(lower) + at.u[i] * static_cast<float>((at.lower[i] >> 8) - lower);
      values[i] = top + at.v[i] * (bottom - top);
    }
    std::copy_n(values.data(), kEdge, samples.col(column).data());
  }
}

/// Bilinear samples of a CV_8UC1 image on a square grid of kEdge x kEdge around
/// `center` [px], one step along a grid axis being a column of `image_from_grid`
/// [px]. False where the grid leaves the image.
template <int kEdge>
bool SampleGrid(const cv::Mat& image, const Eigen::Vector2d& center,
                const Eigen::Matrix2d& image_from_grid,
                Eigen::Matrix<float, kEdge, kEdge>& samples) {
  constexpr double kHalf = 0.5 * (kEdge - 1);
  const Eigen::Vector2d reach = kHalf * image_from_grid.cwiseAbs().rowwise().sum();
  const Eigen::Vector2d low = center - reach, high = center + reach;
  if (!(low.minCoeff() >= 0 && high.x() < image.cols - 1.001 && high.y() < image.rows - 1.001))
    return false;
  if (image_from_grid == Eigen::Matrix2d::Identity()) {
    SampleUprightGrid<kEdge>(image, low, samples);
    return true;
  }
  SampleTurnedGrid<kEdge>(image, center, image_from_grid, samples);
  return true;
}

}  // namespace parkade
