#include "mapping/heights/height_certainty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace parkade {
namespace {

/// A street along x whose middle was measured; beside it only a far guess is known.
HeightField Street(double wave_height) {
  std::vector<HeightObservation> heights;
  for (double x = 0.2; x < 40; x += 0.4)
    for (double y = -9.8; y < 10; y += 0.4) {
      const double height = wave_height * std::sin(x / 2);
      const bool is_known = std::abs(y) < 2;
      heights.push_back({{x, y, is_known ? height : 0}, is_known ? 1e4 : 1.0});
    }
  return HeightField(heights, {});
}

double SigmaAt(const HeightField& field, double x, double y) {
  return field.SigmaOf(field.FindPatch({x, y, 0}));
}

TEST(AddScatter, ObservationsThatDisagreeKnowLess) {
  std::vector<HeightObservation> heights;
  for (double x = 0.2; x < 40; x += 0.4)
    for (double y = -1.8; y < 2; y += 0.4)
      for (const double off : {-0.03, -0.03, 0.03, 0.03})  // four drives
        heights.push_back({{x, y, x < 20 ? 0 : off}, 1e4, x < 20 ? 0.01 : 0.005});
  HeightField field(heights, {});
  ASSERT_NEAR(SigmaAt(field, 30, 0), 0.005, 1e-9);

  AddScatter(heights, field);

  EXPECT_NEAR(SigmaAt(field, 10, 0), 0.01, 1e-4);
  EXPECT_NEAR(SigmaAt(field, 30, 0), std::hypot(0.005, 0.015), 1e-3);
}

TEST(SpreadSigmas, FlatGroundIsKnownForAsFarAsItIsFlat) {
  HeightField field = Street(0);
  EXPECT_GT(SigmaAt(field, 20, 7), 0.9);

  SpreadSigmas(field);

  EXPECT_NEAR(SigmaAt(field, 20, 0), 0.01, 1e-9);
  EXPECT_LT(SigmaAt(field, 20, 7), 0.03);
}

TEST(SpreadSigmas, GroundThatBendsIsNot) {
  HeightField field = Street(0.2);

  SpreadSigmas(field);

  EXPECT_LT(SigmaAt(field, 20, 3), 0.1);
  EXPECT_GT(SigmaAt(field, 20, 7), 0.2);
  EXPECT_LE(SigmaAt(field, 20, 3), SigmaAt(field, 20, 5)) << "less is known farther away";
}

TEST(SpreadSigmas, WhereNothingWasMeasuredNothingChanges) {
  std::vector<HeightObservation> heights;
  for (double x = 0.2; x < 8; x += 0.4) heights.push_back({{x, 0.2, 0}, 100});
  HeightField field(heights, {});

  SpreadSigmas(field);

  EXPECT_NEAR(SigmaAt(field, 4.2, 0.2), 0.1, 1e-9);
}

}  // namespace
}  // namespace parkade
