#include "mapping/ground/image_sampling.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>

namespace parkade {
namespace {

/// An image that ends where its memory does, of random values.
struct TightImage {
  TightImage(int rows, int columns, int channels)
      : bytes(new std::uint8_t[static_cast<std::size_t>(rows * columns * channels)]),
        image(rows, columns, CV_8UC(channels), bytes.get()) {
    std::mt19937 random(5);
    for (int i = 0; i < rows * columns * channels; ++i)
      bytes[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(random());
  }

  std::unique_ptr<std::uint8_t[]> bytes;
  cv::Mat image;
};

TEST(ColorAt, IsTheBilinearMeanOfFourPixelsChannelByChannel) {
  for (const int channels : {1, 3}) {
    const TightImage tight(5, 7, channels);
    for (const float column : {0.0F, 0.3F, 2.5F, 5.0F, 5.75F, 6.0F})
      for (const float row : {0.0F, 1.25F, 3.0F, 3.5F, 4.0F}) {
        const int x = std::min(static_cast<int>(column), 5), y = std::min(static_cast<int>(row), 3);
        const double fx = double{column} - x, fy = double{row} - y;
        const std::array<float, 3> color = ColorAt(tight.image, column, row);
        for (int c = 0; c < 3; ++c) {
          const auto at = [&](int dx, int dy) {
            return static_cast<double>(
                tight.image.ptr(y + dy)[(x + dx) * channels + (channels == 3 ? c : 0)]);
          };
          const double mean = (at(0, 0) * (1 - fx) + at(1, 0) * fx) * (1 - fy) +
                              (at(0, 1) * (1 - fx) + at(1, 1) * fx) * fy;
          EXPECT_NEAR(double{color[static_cast<std::size_t>(c)]}, mean, 1e-4)
              << column << " " << row;
        }
      }
  }
}

}  // namespace
}  // namespace parkade
