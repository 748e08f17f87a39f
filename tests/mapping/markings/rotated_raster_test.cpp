#include "mapping/markings/rotated_raster.h"

#include <gtest/gtest.h>

#include "mapping/markings/ground_tiles.h"

namespace parkade {
namespace {

/// A strip of ground, 40 pixels wide, that runs from one corner of an empty image to the other.
cv::Mat1b MaskOfStrip(int size) {
  cv::Mat1b mask(size, size, std::uint8_t{0});
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column)
      if (std::abs(column + row - (size - 1)) < 28) mask(row, column) = GroundTile::kSure;
  return mask;
}

TEST(RotatedRaster, HoldsWhatWasSeenAndItsMargin) {
  const cv::Mat1b mask = MaskOfStrip(400);
  cv::Mat1f brightness(mask.size());
  for (int row = 0; row < brightness.rows; ++row)
    for (int column = 0; column < brightness.cols; ++column)
      brightness(row, column) = static_cast<float>(0.2 * column + 0.1 * row);

  const RotatedRaster raster(brightness, mask, /*source_size=*/0.02, /*direction=*/M_PI / 4,
                             /*pixel_size=*/0.02, /*margin=*/0.2);

  EXPECT_LT(raster.mask().cols, 40 + 2 * 15);
  EXPECT_NEAR(cv::sum(raster.mask())[0], cv::countNonZero(mask), 0.01 * cv::countNonZero(mask));
  EXPECT_EQ(cv::sum(raster.mask()(cv::Rect(0, 0, 10, raster.mask().rows)))[0], 0);
  for (int row = 0; row < raster.mask().rows; row += 7)
    for (int column = 0; column < raster.mask().cols; column += 5) {
      if (raster.mask().at<float>(row, column) == 0) continue;
      const Eigen::Vector2d source = raster.SourceOf(column, row);
      EXPECT_NEAR(raster.brightness().at<float>(row, column), 0.2 * source.x() + 0.1 * source.y(),
                  0.1);
    }
}

TEST(RotatedRaster, OfNothingIsAPixel) {
  const cv::Mat1b mask(50, 50, std::uint8_t{0});
  const RotatedRaster raster(cv::Mat1f(50, 50, 0.0F), mask, 0.02, 0.3, 0.02, 0.2);
  EXPECT_EQ(raster.mask().total(), 1U);
}

}  // namespace
}  // namespace parkade
