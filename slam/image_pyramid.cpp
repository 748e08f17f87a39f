#include "slam/image_pyramid.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace parkade {
namespace {

constexpr int kStatisticsScale = 8;     ///< local mean and contrast vary slowly: one value per 8 x 8 px
constexpr double kTargetContrast = 40;  ///< [grey levels] standard deviation after normalising
constexpr double kNeighbourhood = 3;    ///< [blocks] standard deviation of the Gaussian around a block

/// Per block of kStatisticsScale: mean of the values and of their squares.
struct LocalMoments {
  cv::Mat mean, mean_square;  ///< CV_32FC1
};

LocalMoments MeasureBlocks(const cv::Mat& gray) {
  const int rows = (gray.rows + kStatisticsScale - 1) / kStatisticsScale;
  const int columns = (gray.cols + kStatisticsScale - 1) / kStatisticsScale;
  LocalMoments moments{cv::Mat(rows, columns, CV_32FC1), cv::Mat(rows, columns, CV_32FC1)};
  std::vector<int> sums(static_cast<size_t>(columns)), squares(static_cast<size_t>(columns));
  for (int block_row = 0; block_row < rows; ++block_row) {
    std::fill(sums.begin(), sums.end(), 0);
    std::fill(squares.begin(), squares.end(), 0);
    const int begin = block_row * kStatisticsScale;
    const int end = std::min(begin + kStatisticsScale, gray.rows);
    for (int y = begin; y < end; ++y) {
      const std::uint8_t* row = gray.ptr<std::uint8_t>(y);
      for (int block = 0; block < columns; ++block) {
        const int first = block * kStatisticsScale;
        const int last = std::min(first + kStatisticsScale, gray.cols);
        int sum = 0, square = 0;
        for (int x = first; x < last; ++x) {
          sum += row[x];
          square += row[x] * row[x];
        }
        sums[static_cast<size_t>(block)] += sum;
        squares[static_cast<size_t>(block)] += square;
      }
    }
    for (int block = 0; block < columns; ++block) {
      const int width = std::min(kStatisticsScale, gray.cols - block * kStatisticsScale);
      const float share = 1.0f / static_cast<float>(width * (end - begin));
      moments.mean.at<float>(block_row, block) = share * static_cast<float>(sums[static_cast<size_t>(block)]);
      moments.mean_square.at<float>(block_row, block) = share * static_cast<float>(squares[static_cast<size_t>(block)]);
    }
  }
  return moments;
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
  cv::GaussianBlur(moments.mean, moments.mean, {}, kNeighbourhood);
  cv::GaussianBlur(moments.mean_square, moments.mean_square, {}, kNeighbourhood);
  cv::Mat gain(moments.mean.size(), CV_32FC1), offset(moments.mean.size(), CV_32FC1);
  for (int y = 0; y < gain.rows; ++y) {
    for (int x = 0; x < gain.cols; ++x) {
      const float mean = moments.mean.at<float>(y, x);
      const float variance = std::max(0.0f, moments.mean_square.at<float>(y, x) - mean * mean);
      gain.at<float>(y, x) = static_cast<float>(kTargetContrast / std::hypot(std::sqrt(variance), noise_floor));
      offset.at<float>(y, x) = 128 - gain.at<float>(y, x) * mean;
    }
  }
  // Blocks are exactly kStatisticsScale wide, so enlarging keeps them in place
  // also where the last block is cut.
  const cv::Size padded = gain.size() * kStatisticsScale;
  cv::Mat full_gain, full_offset;
  cv::resize(gain, full_gain, padded, 0, 0, cv::INTER_LINEAR);
  cv::resize(offset, full_offset, padded, 0, 0, cv::INTER_LINEAR);
  cv::Mat normalized(gray.size(), CV_8UC1);
  for (int y = 0; y < gray.rows; ++y) {
    const std::uint8_t* from = gray.ptr<std::uint8_t>(y);
    const float* a = full_gain.ptr<float>(y);
    const float* b = full_offset.ptr<float>(y);
    std::uint8_t* to = normalized.ptr<std::uint8_t>(y);
    for (int x = 0; x < gray.cols; ++x) {
      const int value = static_cast<int>(a[x] * static_cast<float>(from[x]) + b[x] + 0.5f);
      to[x] = static_cast<std::uint8_t>(std::clamp(value, 0, 255));
    }
  }
  return normalized;
}

std::vector<cv::Mat> BuildPyramid(const cv::Mat& gray, int window, int levels) {
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(gray, pyramid, {window, window}, levels - 1, /*withDerivatives=*/true);
  return pyramid;
}

cv::Mat UsablePixels(const CameraModel& model, const cv::Mat& mask, int margin) {
  constexpr int kStep = 4;  // lens domains are round and large: every 4th pixel finds their edge
  cv::Mat usable = cv::Mat::zeros(model.height(), model.width(), CV_8UC1);
  for (int y = 0; y < usable.rows; y += kStep) {
    for (int x = 0; x < usable.cols; x += kStep) {
      const Eigen::Vector2d pixel(std::min(x + kStep / 2, usable.cols - 1), std::min(y + kStep / 2, usable.rows - 1));
      if (model.Unproject(pixel) && model.PixelsPerRadian(pixel).value_or(0) > 0)
        usable(cv::Rect(x, y, kStep, kStep) & cv::Rect(0, 0, usable.cols, usable.rows)) = 255;
    }
  }
  if (!mask.empty()) usable.setTo(0, mask == 0);
  usable.row(0) = 0;
  usable.row(usable.rows - 1) = 0;
  usable.col(0) = 0;
  usable.col(usable.cols - 1) = 0;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * margin + 1, 2 * margin + 1});
  cv::erode(usable, usable, disc);
  return usable;
}

bool IsBlank(const cv::Mat& gray, const cv::Mat& usable) {
  constexpr int kStep = 4;
  constexpr double kMinContrast = 2;  // [grey levels]; read noise alone stays below
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
  return count == 0 || squares / count - (sum / count) * (sum / count) < kMinContrast * kMinContrast;
}

}  // namespace parkade
