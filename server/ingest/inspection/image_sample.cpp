#include "server/ingest/inspection/image_sample.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>

namespace parkade {
namespace {

constexpr int kMinWidth = 160, kMinHeight = 100;

/// Means of the blocks of a CV_32FC1 image.
std::array<float, ImageSample::kBlocks> MeansOfBlocks(const cv::Mat& image) {
  std::array<float, ImageSample::kBlocks> means{};
  for (int row = 0; row < ImageSample::kRows; ++row) {
    const cv::Range rows(image.rows * row / ImageSample::kRows,
                         image.rows * (row + 1) / ImageSample::kRows);
    for (int column = 0; column < ImageSample::kColumns; ++column) {
      const cv::Range columns(image.cols * column / ImageSample::kColumns,
                              image.cols * (column + 1) / ImageSample::kColumns);
      means[static_cast<std::size_t>(row * ImageSample::kColumns + column)] =
          static_cast<float>(cv::mean(image(rows, columns))[0]);
    }
  }
  return means;
}

/// The image, made smaller by a whole number.
cv::Mat Smaller(const cv::Mat& gray, int factor) {
  cv::Mat small;
  cv::resize(gray, small, {gray.cols / factor, gray.rows / factor}, 0, 0, cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  return small;
}

/// How far the pixels of each block are from the mean of their neighborhood, in gray levels.
std::array<float, ImageSample::kBlocks> DetailOfBlocks(const cv::Mat& image) {
  cv::Mat smooth, detail;
  cv::blur(image, smooth, {3, 3});
  cv::absdiff(image, smooth, detail);
  return MeansOfBlocks(detail);
}

}  // namespace

ImageGlance GlanceAt(const cv::Mat& gray) {
  constexpr int kStep = 8;  // in both directions, for the brightness
  constexpr double kShare = 0.01;
  std::array<int, 256> histogram{};
  int count = 0;
  std::uint64_t hash = 0x9e3779b97f4a7c15ULL;
  const auto mix = [&](std::uint64_t word) {
    hash = (hash ^ word) * 0xff51afd7ed558ccdULL;
    hash ^= hash >> 32;
  };
  for (int y = 0; y < gray.rows; ++y) {
    const std::uint8_t* row = gray.ptr(y);
    const std::size_t size = static_cast<std::size_t>(gray.cols);
    std::uint64_t word = 0;
    std::size_t at = 0;
    for (; at + sizeof word <= size; at += sizeof word) {
      std::memcpy(&word, row + at, sizeof word);
      mix(word);
    }
    word = 0;
    std::memcpy(&word, row + at, size - at);
    mix(word);
    if (y % kStep != 0) continue;
    for (std::size_t x = 0; x < size; x += kStep, ++count) ++histogram[row[x]];
  }
  ImageGlance glance{.brightest = 255, .content = hash};
  for (int above = 0; glance.brightest > 0; --glance.brightest) {
    above += histogram[static_cast<std::size_t>(glance.brightest)];
    if (above > kShare * count) break;
  }
  return glance;
}

std::optional<ImageSample> SampleOf(const cv::Mat& gray) {
  if (gray.cols < kMinWidth || gray.rows < kMinHeight) return std::nullopt;
  constexpr int kUsualWidth = 320;
  constexpr float kNoiseRatio = 0.6f;  // coarse to fine, below which all is noise
  constexpr float kDark =
      8;  // gray levels added to the brightness: in the dark contrast means nothing
  const int factor =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(gray.cols) / kUsualWidth)));
  const cv::Mat small = Smaller(gray, factor);
  const auto brightness = MeansOfBlocks(small), fine_detail = DetailOfBlocks(small),
             coarse_detail = DetailOfBlocks(Smaller(gray, 2 * factor));
  ImageSample sample;
  for (std::size_t i = 0; i < ImageSample::kBlocks; ++i) {
    sample.brightness[i] = static_cast<std::uint8_t>(std::lround(brightness[i]));
    // White noise loses half of its strength from one size to the next, real detail hardly any.
    const float fine = fine_detail[i], coarse = coarse_detail[i];
    const float detail =
        coarse < kNoiseRatio * fine ? 0 : std::sqrt((4 * coarse * coarse - fine * fine) / 3);
    const float contrast = detail / (brightness[i] + kDark);
    sample.contrast[i] = static_cast<std::uint8_t>(
        std::lround(std::min(255., contrast / ImageSample::kContrastUnit)));
  }
  return sample;
}

}  // namespace parkade
