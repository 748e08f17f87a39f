#include <gtest/gtest.h>

#include "tests/simulator/common/mip_texture.h"
#include "tests/simulator/ground/ground_canvas.h"

namespace parkade::simulator {
namespace {

float RootMeanSquare(const MipTexture& texture, float footprint) {
  double sum = 0;
  for (int i = 0; i < 4000; ++i) {
    const float value =
        texture.Sample(0.37f * static_cast<float>(i), 0.613f * static_cast<float>(i), footprint);
    sum += value * value;
  }
  return static_cast<float>(std::sqrt(sum / 4000));
}

TEST(MipTexture, EveryKindHasUnitContrastCloseUpAndNoneFromAfar) {
  for (int kind = 1; kind < kNumTextureKinds; ++kind) {
    const MipTexture& texture = DetailTexture(static_cast<TextureKind>(kind));
    EXPECT_NEAR(RootMeanSquare(texture, 1e-4f), 1, 0.2) << kind;
    EXPECT_LT(RootMeanSquare(texture, 1), 0.05f) << kind;
  }
}

TEST(MipTexture, ContrastFallsSteadilyWithTheFootprint) {
  const MipTexture& texture = DetailTexture(TextureKind::kAggregate);
  for (float footprint = 1e-3f; footprint < 0.4f; footprint *= 2)
    EXPECT_LT(RootMeanSquare(texture, 2 * footprint), 1.02f * RootMeanSquare(texture, footprint));
}

TEST(GroundCanvas, CoarseSamplesAreTheMeanReflectance) {
  GroundCanvas canvas({0, 0}, {2.56, 2.56}, 0.01);
  canvas.Fill([](float x, float y) {
    const int square = static_cast<int>(x / 0.02f) + static_cast<int>(y / 0.02f);
    return Gray(square % 2 == 0 ? 0.8f : 0.0f);
  });
  canvas.Finish();

  EXPECT_NEAR(canvas.Sample(1.29f, 1.29f, 0.005f)[1], 0.8, 0.01);
  EXPECT_NEAR(canvas.Sample(1.30f, 1.27f, 0.64f)[1], 0.4, 0.02);
}

TEST(GroundCanvas, PaintLandsWhereItIsPut) {
  GroundCanvas canvas({-1, -2}, {3, 2}, 0.01);
  canvas.Paint({1, 0.5}, 0.1, [](float, float) {
    return GroundCanvas::Touch{Rgb(0.5f, 0.2f, 0.1f), 1};
  });
  canvas.Finish();

  EXPECT_NEAR(canvas.Sample(1, 0.5f, 0.01f)[0], 0.5, 0.01);
  EXPECT_NEAR(canvas.Sample(1, 0.5f, 0.01f)[2], 0.1, 0.01);
  EXPECT_EQ(canvas.Sample(1.2f, 0.5f, 0.01f)[0], 0);
}

}  // namespace
}  // namespace parkade::simulator
