#include "mapping/markings/paint_lines.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "mapping/markings/paint_areas.h"
#include "tests/mapping/worlds/painted_ground.h"

namespace parkade {
namespace {

using Eigen::Vector2d;

/// [m] of the nearer end of a line to a place.
double EndError(const PaintLine& line, const Vector2d& place) {
  return std::min((line.begin - place).norm(), (line.end - place).norm());
}

TEST(PaintLines, AreFoundAtAnyAngleToTwoCentimeters) {
  for (const double degrees : {0.0, 17.0, 45.0, 90.0, 133.0}) {
    PaintedGround ground(16);
    const double angle = degrees * M_PI / 180;
    const Vector2d along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x());
    for (const double place : {-2.5, 0.0, 2.5})
      ground.Line(place * across - 2.5 * along, place * across + 2.5 * along);
    const std::vector<PaintLine> lines = FindPaintLines(ground.tile());
    ASSERT_EQ(lines.size(), 3U) << degrees;
    for (const PaintLine& line : lines) {
      const double place = std::round(line.Middle().dot(across) / 2.5) * 2.5;
      EXPECT_NEAR(line.begin.dot(across), place, 0.015) << degrees;
      EXPECT_NEAR(line.end.dot(across), place, 0.015) << degrees;
      EXPECT_LT(EndError(line, place * across - 2.5 * along), 0.04) << degrees;
      EXPECT_LT(EndError(line, place * across + 2.5 * along), 0.04) << degrees;
      EXPECT_TRUE(line.is_begin_seen && line.is_end_seen);
      EXPECT_FALSE(line.is_yellow);
      EXPECT_NEAR(line.width, 0.12, 0.04);
    }
  }
}

TEST(PaintLines, OfWornPaintAreFoundWhole) {
  PaintedGround ground(16);
  ground.Line({0, -2.5}, {0, 2.5}, 0.12, cv::Scalar::all(190), 2);
  const std::vector<PaintLine> lines = FindPaintLines(ground.tile());
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NEAR(lines[0].Length(), 5, 0.3);
}

TEST(PaintLines, KnowYellowFromWhite) {
  PaintedGround ground(16);
  ground.Line({0, -2.5}, {0, 2.5}, 0.12, cv::Scalar(60, 170, 200));
  const std::vector<PaintLine> lines = FindPaintLines(ground.tile());
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].is_yellow);
}

TEST(PaintLines, EndUnseenWhereTheGroundDoes) {
  PaintedGround ground(16);
  ground.Line({0, -2.5}, {0, 2.5});
  ground.Hide({-2, 0.5}, {2, 4});
  const std::vector<PaintLine> lines = FindPaintLines(ground.tile());
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NEAR(lines[0].Length(), 3, 0.15);
  EXPECT_NE(lines[0].is_begin_seen, lines[0].is_end_seen);
}

TEST(PaintLines, AreNotFoundInBareGround) {
  EXPECT_TRUE(FindPaintLines(PaintedGround(16).tile()).empty());
  EXPECT_TRUE(FindPaintLines(PaintedGround(16, 0.02, 30).tile()).empty());
}

TEST(PaintLines, DarkStripesAndEdgesOfShadowsAreNone) {
  PaintedGround ground(16);
  ground.Line({-3, -2.5}, {-3, 2.5}, 0.12, cv::Scalar::all(50));
  ground.Polygon({{1, -8}, {8, -8}, {8, 8}, {1, 8}}, cv::Scalar::all(60));
  EXPECT_TRUE(FindPaintLines(ground.tile()).empty());
}

TEST(PaintLines, RefuseOptionsThatMakeNoSense) {
  EXPECT_THROW(FindPaintLines(PaintedGround(4).tile(), {.stripe_width = 0.01}), Error);
}

TEST(PaintAreas, AreArrowsAndNotLines) {
  PaintedGround ground(16);
  ground.Line({-5, -2.5}, {-5, 2.5});
  ground.Polygon({{-1, -0.08}, {1, -0.08}, {1, -0.35}, {2, 0}, {1, 0.35}, {1, 0.08}, {-1, 0.08}},
                 cv::Scalar(60, 170, 200));
  const std::vector<PaintArea> areas = FindPaintAreas(ground.tile());
  ASSERT_EQ(areas.size(), 1U);
  EXPECT_TRUE(areas[0].is_yellow);
  double twice = 0;
  for (std::size_t i = 0; i < areas[0].outline.size(); ++i) {
    const Vector2d &a = areas[0].outline[i],
                   &b = areas[0].outline[(i + 1) % areas[0].outline.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  EXPECT_NEAR(std::abs(twice) / 2, 0.67, 0.15);
}

}  // namespace
}  // namespace parkade
