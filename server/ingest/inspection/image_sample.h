#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>

namespace parkade {

/// Measures of every image; takes some tens of microseconds for one of 640x400.
struct ImageGlance {
  int brightest = 0;          ///< gray level that 1 % of the pixels reach
  std::uint64_t content = 0;  ///< hash of all pixels: equal images have the same
};

/// Measures of a few images: a grid of blocks over the image, row by row from the upper left.
struct ImageSample {
  static constexpr int kRows = 10, kColumns = 16;
  static constexpr std::size_t kBlocks = kRows * kColumns;
  static constexpr double kContrastUnit = 1e-3;

  std::array<std::uint8_t, kBlocks> brightness{};  ///< mean gray level
  /// How much detail there is beyond noise, against the brightness, in kContrastUnit: does not
  /// depend on the exposure.
  std::array<std::uint8_t, kBlocks> contrast{};
};

/// Measures an image. `gray`: CV_8UC1, not empty. Thread-safe, like SampleImage.
ImageGlance GlanceAt(const cv::Mat& gray);

/// Samples an image. Takes about as long as two blurs of an image of 320 pixels' width, after it
/// was made as small as that. Nothing for images below 160x100 pixels, which have too little detail
/// to miss.
std::optional<ImageSample> SampleOf(const cv::Mat& gray);

}  // namespace parkade
