#include "slam/tracking/image_pyramid.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/math/vectorized.h"

namespace parkade {
namespace {

constexpr int kStatisticsScale =
    8;  ///< local mean and contrast vary slowly: one value per 8 x 8 px
constexpr double kTargetContrast = 40;  ///< [gray levels] standard deviation after normalizing
constexpr double kNeighborhood = 3;  ///< [blocks] standard deviation of the Gaussian around a block

/// Mean of the values and of their squares, per block of kStatisticsScale.
struct LocalMoments {
  cv::Mat mean, mean_square;  ///< CV_32FC1
};

LocalMoments MeasureBlocks(const cv::Mat& gray) {
  const int rows = (gray.rows + kStatisticsScale - 1) / kStatisticsScale;
  const int columns = (gray.cols + kStatisticsScale - 1) / kStatisticsScale;
  LocalMoments moments{cv::Mat(rows, columns, CV_32FC1), cv::Mat(rows, columns, CV_32FC1)};
  const auto width = static_cast<size_t>(gray.cols);
  std::vector<std::uint16_t> sums(
      width);  // per column of pixels: what the compiler adds up many at a time
  std::vector<std::uint32_t> squares(width);
  for (int block_row = 0; block_row < rows; ++block_row) {
    std::fill(sums.begin(), sums.end(), std::uint16_t{0});
    std::fill(squares.begin(), squares.end(), 0u);
    const int begin = block_row * kStatisticsScale;
    const int end = std::min(begin + kStatisticsScale, gray.rows);
    for (int y = begin; y < end; ++y) {
      const std::uint8_t* row = gray.ptr<std::uint8_t>(y);
      for (size_t x = 0; x < width; ++x) {
        sums[x] = static_cast<std::uint16_t>(sums[x] + row[x]);
        squares[x] += static_cast<std::uint32_t>(row[x] * row[x]);
      }
    }
    for (int block = 0; block < columns; ++block) {
      const int first = block * kStatisticsScale,
                last = std::min(first + kStatisticsScale, gray.cols);
      std::uint32_t sum = 0, square = 0;
      for (int x = first; x < last; ++x) {
        sum += sums[static_cast<size_t>(x)];
        square += squares[static_cast<size_t>(x)];
      }
      const float share = 1.0f / static_cast<float>((last - first) * (end - begin));
      moments.mean.at<float>(block_row, block) = share * static_cast<float>(sum);
      moments.mean_square.at<float>(block_row, block) = share * static_cast<float>(square);
    }
  }
  return moments;
}

/// Values of blocks, linear between their centers and constant outside: one row of pixels at a
/// time.
class BlockRow {
 public:
  explicit BlockRow(const cv::Mat& blocks) : blocks_(blocks) {}

  /// Size of the buffer that At wants.
  size_t size() const { return static_cast<size_t>((blocks_.cols + 1) * kStatisticsScale); }

  /// Values of the pixels of row `y`, held by `buffer`.
  const float* At(int y, std::vector<float>& buffer) const {
    assert(buffer.size() == size());
    const float place = (static_cast<float>(y) + 0.5f) / kStatisticsScale +
                        0.5f;  // in rows of blocks, from one above
    const int below = std::min(static_cast<int>(place), blocks_.rows - 1),
              above = std::max(static_cast<int>(place) - 1, 0);
    const float share = place - std::floor(place);
    const float *upper = blocks_.ptr<float>(above), *lower = blocks_.ptr<float>(below);
    const auto value = [&](int column) {
      return upper[column] + share * (lower[column] - upper[column]);
    };
    float left = value(0);
    for (int column = 0; column <= blocks_.cols; ++column) {
      const float right = value(std::min(column, blocks_.cols - 1));
      float* out = buffer.data() + column * kStatisticsScale;
      for (int i = 0; i < kStatisticsScale; ++i)
        out[i] = left + (static_cast<float>(i) + 0.5f) / kStatisticsScale * (right - left);
      left = right;
    }
    return buffer.data() + kStatisticsScale / 2;  // the buffer begins half a block to the left
  }

 private:
  const cv::Mat& blocks_;
};

PARKADE_VECTORIZED_FLOATS void ScaleRow(const std::uint8_t* __restrict from,
                                        const float* __restrict gain,
                                        const float* __restrict offset, int width,
                                        std::uint8_t* __restrict to) {
  for (int x = 0; x < width; ++x) {
    const float value = gain[x] * static_cast<float>(from[x]) + offset[x] + 0.5f;
    to[x] = static_cast<std::uint8_t>(static_cast<int>(std::min(std::max(value, 0.0f), 255.0f)));
  }
}

}  // namespace

cv::Mat ToGray(const cv::Mat& image, const cv::Size& size) {
  if (image.size() != size) return {};
  if (image.type() == CV_8UC1) return image;
  cv::Mat gray;
  if (image.type() == CV_8UC3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

cv::Mat NormalizeLocally(const cv::Mat& gray, double noise_floor) {
  LocalMoments moments = MeasureBlocks(gray);
  cv::GaussianBlur(moments.mean, moments.mean, {}, kNeighborhood);
  cv::GaussianBlur(moments.mean_square, moments.mean_square, {}, kNeighborhood);
  cv::Mat gain(moments.mean.size(), CV_32FC1), offset(moments.mean.size(), CV_32FC1);
  for (int y = 0; y < gain.rows; ++y) {
    for (int x = 0; x < gain.cols; ++x) {
      const float mean = moments.mean.at<float>(y, x);
      const float variance = std::max(0.0f, moments.mean_square.at<float>(y, x) - mean * mean);
      gain.at<float>(y, x) =
          static_cast<float>(kTargetContrast / std::hypot(std::sqrt(variance), noise_floor));
      offset.at<float>(y, x) = 128 - gain.at<float>(y, x) * mean;
    }
  }
  const BlockRow gain_rows(gain), offset_rows(offset);
  std::vector<float> row_gain(gain_rows.size()), row_offset(gain_rows.size());
  cv::Mat normalized(gray.size(), CV_8UC1);
  for (int y = 0; y < gray.rows; ++y)
    ScaleRow(gray.ptr<std::uint8_t>(y), gain_rows.At(y, row_gain), offset_rows.At(y, row_offset),
             gray.cols, normalized.ptr<std::uint8_t>(y));
  return normalized;
}

std::vector<cv::Mat> BuildPyramid(const cv::Mat& gray, int levels) {
  constexpr int kBorder = kPyramidBorder, kMinEdge = 18;  // [px]
  std::vector<cv::Mat> pyramid;
  cv::Mat level = gray;
  while (true) {
    cv::Mat wide;
    cv::copyMakeBorder(level, wide, kBorder, kBorder, kBorder, kBorder, cv::BORDER_REFLECT_101);
    pyramid.push_back(wide(cv::Rect({kBorder, kBorder}, level.size())));
    const cv::Size half((level.cols + 1) / 2, (level.rows + 1) / 2);
    if (std::ssize(pyramid) == levels || std::min(half.width, half.height) < kMinEdge)
      return pyramid;
    cv::Mat next;
    cv::pyrDown(level, next, half);
    level = next;
  }
}

cv::Mat UsablePixels(const CameraModel& model, const cv::Mat& mask, int margin) {
  constexpr int kStep = 4;  // lens domains are round and large: every 4th pixel finds their edge
  cv::Mat usable = cv::Mat::zeros(model.height(), model.width(), CV_8UC1);
  for (int y = 0; y < usable.rows; y += kStep) {
    for (int x = 0; x < usable.cols; x += kStep) {
      const Eigen::Vector2d pixel(std::min(x + kStep / 2, usable.cols - 1),
                                  std::min(y + kStep / 2, usable.rows - 1));
      if (model.Unproject(pixel) && model.PixelsPerRadian(pixel).value_or(0) > 0)
        usable(cv::Rect(x, y, kStep, kStep) & cv::Rect(0, 0, usable.cols, usable.rows)) = 255;
    }
  }
  if (!mask.empty()) usable.setTo(0, mask == 0);
  usable.row(0) = 0;
  usable.row(usable.rows - 1) = 0;
  usable.col(0) = 0;
  usable.col(usable.cols - 1) = 0;
  const cv::Mat disc =
      cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * margin + 1, 2 * margin + 1});
  cv::erode(usable, usable, disc);
  return usable;
}

bool IsBlank(const cv::Mat& gray, const cv::Mat& usable) {
  constexpr int kStep = 4;
  constexpr double kMinContrast = 2;  // [gray levels]; read noise alone stays below
  double count = 0, sum = 0, squares = 0;
  for (int y = kStep / 2; y < gray.rows; y += kStep) {
    for (int x = kStep / 2; x < gray.cols; x += kStep) {
      if (usable.at<std::uint8_t>(y, x) == 0) continue;
      const double value = gray.at<std::uint8_t>(y, x);
      count += 1;
      sum += value;
      squares += value * value;
    }
  }
  return count == 0 ||
         squares / count - (sum / count) * (sum / count) < kMinContrast * kMinContrast;
}

}  // namespace parkade
