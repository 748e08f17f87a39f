#pragma once

#include <Eigen/Core>
#include <cstdint>
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
  const Eigen::Vector2f right = image_from_grid.col(0).cast<float>();
  const Eigen::Vector2f down = image_from_grid.col(1).cast<float>();
  const Eigen::Vector2f first =
      (center - kHalf * (image_from_grid.col(0) + image_from_grid.col(1))).cast<float>();
  for (int row = 0; row < kEdge; ++row) {
    for (int column = 0; column < kEdge; ++column) {
      const Eigen::Vector2f at =
          (first + static_cast<float>(row) * down + static_cast<float>(column) * right).cwiseMax(0);
      const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
      const float u = at.x() - static_cast<float>(x), v = at.y() - static_cast<float>(y);
      const std::uint8_t* upper = image.ptr<std::uint8_t>(y) + x;
      const std::uint8_t* lower = image.ptr<std::uint8_t>(y + 1) + x;
      const float top = static_cast<float>(upper[0]) + u * static_cast<float>(upper[1] - upper[0]);
      const float bottom =
          static_cast<float>(lower[0]) + u * static_cast<float>(lower[1] - lower[0]);
      samples(row, column) = top + v * (bottom - top);
    }
  }
  return true;
}

}  // namespace parkade
