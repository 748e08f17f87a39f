#include "mapping/networks/simple_layers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/mapping/worlds/layer_run.h"

namespace parkade {
namespace {

constexpr int kChannels = 12;

TEST(DoublingLayer, IsBilinearBetweenCentersAndConstantBeyondThoseAtTheBorder) {
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(5, 3)}) {
    const LayerRun run(*MakeDoublingLayer(), size, kChannels, true);

    ASSERT_EQ(run.output.size, size * 2);
    for (int row = 0; row < run.output.size.height; ++row)
      for (int column = 0; column < run.output.size.width; ++column) {
        const double x = std::clamp((column + 0.5) / 2 - 0.5, 0.0, size.width - 1.0);
        const double y = std::clamp((row + 0.5) / 2 - 0.5, 0.0, size.height - 1.0);
        const int left = static_cast<int>(x), top = static_cast<int>(y);
        const auto at = [&](int i, int j) {
          return static_cast<double>(run.input.At(std::min(i, size.height - 1),
                                                  std::min(j, size.width - 1))[kChannels - 1]);
        };
        const double upper = at(top, left) + (x - left) * (at(top, left + 1) - at(top, left));
        const double lower =
            at(top + 1, left) + (x - left) * (at(top + 1, left + 1) - at(top + 1, left));
        EXPECT_NEAR(run.output.At(row, column)[kChannels - 1],
                    upper + (y - top) * (lower - upper) + run.AddedAt(row, column, kChannels - 1),
                    1e-6);
      }
  }
}

TEST(ElementLayers, ScaleAndTanhAreOfEachNumberAlone) {
  const LayerRun scaled(*MakeScaleLayer(-3), {4, 3}, 1, false);
  const LayerRun bounded(*MakeTanhLayer(), {4, 3}, 1, false);

  for (int column = 0; column < 4; ++column) {
    EXPECT_FLOAT_EQ(scaled.output.At(2, column)[0], -3 * scaled.input.At(2, column)[0]);
    EXPECT_FLOAT_EQ(bounded.output.At(2, column)[0], std::tanh(bounded.input.At(2, column)[0]));
  }
}

}  // namespace
}  // namespace parkade
