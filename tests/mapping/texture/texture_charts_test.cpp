#include "mapping/texture/texture_charts.h"

#include <gtest/gtest.h>

#include <numbers>
#include <opencv2/core.hpp>

#include "tests/mapping/worlds/all_charts.h"
#include "tests/mapping/worlds/test_surfaces.h"

namespace parkade {
namespace {

/// A helix of `turns` with a pitch of `rise` [m] per turn around (5, 5), 2 m to 6 m from its axis.
TriangleMesh MakeHelix(double turns, double rise) {
  TriangleMesh mesh;
  const int steps = static_cast<int>(48 * turns);
  for (int i = 0; i <= steps; ++i)
    for (const double radius : {2.0, 6.0}) {
      const double angle = 2 * std::numbers::pi * i / 48;
      mesh.vertices.emplace_back(static_cast<float>(5 + radius * std::cos(angle)),
                                 static_cast<float>(5 + radius * std::sin(angle)),
                                 static_cast<float>(rise * i / 48));
      mesh.normals.push_back(Eigen::Vector3f::UnitZ());
      mesh.colors.push_back({128, 128, 128});
      mesh.height_sigmas.push_back(0);
    }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(steps); ++i) {
    mesh.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 3});
    mesh.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 2});
  }
  return mesh;
}

void ExpectEveryTriangleOnce(const TriangleMesh& mesh, const std::vector<BlankChart>& charts) {
  std::vector<int> count(mesh.triangles.size());
  for (const BlankChart& blank : charts)
    for (const std::uint32_t triangle : blank.chart.triangles) ++count[triangle];
  for (const int number : count) EXPECT_EQ(number, 1);
}

TEST(TextureCharts, HoldTheHeightOfThePlaneBelowEachTexel) {
  TriangleMesh mesh;
  mesh.origin = {100, 200, 5};
  AddRectangle(mesh, -1, -2, 3, 1, 0);
  for (Eigen::Vector3f& vertex : mesh.vertices) vertex.z() = 0.1F * vertex.x() - 0.05F * vertex.y();

  const auto charts = CutIntoCharts(mesh, 1000, 0.1);

  ASSERT_EQ(charts.size(), 1u);
  const BlankChart& blank = charts[0];
  EXPECT_EQ(cv::countNonZero(blank.chart.mask), 40 * 30);
  for (int row = 0; row < blank.height.rows; ++row)
    for (int column = 0; column < blank.height.cols; ++column) {
      if (blank.chart.mask.at<std::uint8_t>(row, column) == 0) continue;
      const double x = blank.chart.left + 0.1 * (column + 0.5) - 100,
                   y = blank.chart.top - 0.1 * (row + 0.5) - 200;
      EXPECT_NEAR(static_cast<double>(blank.height.at<float>(row, column)), 5 + 0.1 * x - 0.05 * y,
                  1e-5);
    }
}

TEST(TextureCharts, AreOnePerSquareWhereTheGroundIsSingle) {
  TriangleMesh mesh;
  for (int x = -2; x < 2; ++x)
    for (int y = -1; y < 2; ++y) AddRectangle(mesh, 8 * x, 8 * y, 8 * x + 8, 8 * y + 8, 0);

  const auto charts = CutIntoCharts(mesh, 16, 0.05);

  EXPECT_EQ(charts.size(), 2u * 2u);
  ExpectEveryTriangleOnce(mesh, charts);
  for (size_t i = 1; i < charts.size(); ++i) {
    const auto key = [](const BlankChart& b) {
      return std::tuple(b.chart.row, b.chart.column, b.chart.layer);
    };
    EXPECT_LT(key(charts[i - 1]), key(charts[i]));
  }
}

TEST(TextureCharts, LeaveNoTexelOutBetweenThem) {
  constexpr double kTexel = 0.02;
  constexpr int kWidth = 800, kHeight = 6;  // [texels]
  TriangleMesh mesh;
  mesh.origin = {4, 9, 0};
  // Every edge between two rectangles goes through centers of texels.
  for (int i = 0; i < 32; ++i) {
    const double left = -20.25 + 0.5 * i;
    AddRectangle(mesh, left, -9.05, left + 0.5, -8.95, 0);
  }

  cv::Mat1i times(kHeight, kWidth, 0);
  for (const BlankChart& blank : CutIntoCharts(mesh, 0.5, kTexel))
    for (int row = 0; row < blank.chart.mask.rows; ++row)
      for (int column = 0; column < blank.chart.mask.cols; ++column)
        if (blank.chart.mask.at<std::uint8_t>(row, column) != 0) {
          const double x = blank.chart.left + kTexel * (column + 0.5) + 16.25,
                       y = 0.05 - (blank.chart.top - kTexel * (row + 0.5));
          const int to_east = static_cast<int>(std::lround(x / kTexel)),
                    to_south = static_cast<int>(std::lround(y / kTexel));
          if (to_east < kWidth && to_south >= 0 && to_south < kHeight) ++times(to_south, to_east);
        }

  EXPECT_EQ(cv::countNonZero(times == 0), 0);
}

TEST(TextureCharts, SeparateDecks) {
  TriangleMesh mesh;
  AddRectangle(mesh, 0, 0, 10, 10, 0);
  AddRectangle(mesh, 4, 0, 10, 10, 2.6);

  const auto charts = CutIntoCharts(mesh, 100, 0.1);

  ASSERT_EQ(charts.size(), 2u);
  ExpectEveryTriangleOnce(mesh, charts);
  EXPECT_EQ(cv::countNonZero(charts[0].chart.mask), 100 * 100);
  EXPECT_EQ(cv::countNonZero(charts[1].chart.mask), 60 * 100);
  EXPECT_EQ(charts[1].chart.layer, 1);
}

TEST(TextureCharts, CutASpiralRampWhereItWouldLieAboveItself) {
  const TriangleMesh mesh = MakeHelix(3, 3.0);

  const auto charts = CutIntoCharts(mesh, 100, 0.05);

  EXPECT_GE(charts.size(), 3u);
  ExpectEveryTriangleOnce(mesh, charts);
  // No chart sees more of the helix than the ring between its radii.
  for (const BlankChart& blank : charts)
    EXPECT_LE(0.05 * 0.05 * cv::countNonZero(blank.chart.mask), std::numbers::pi * (36 - 4) * 1.01);
  double area = 0;
  for (const BlankChart& blank : charts) area += 0.05 * 0.05 * cv::countNonZero(blank.chart.mask);
  EXPECT_NEAR(area, 3 * std::numbers::pi * (36 - 4), 0.02 * 3 * std::numbers::pi * (36 - 4));
}

}  // namespace
}  // namespace parkade
