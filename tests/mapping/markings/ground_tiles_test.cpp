#include "mapping/markings/ground_tiles.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

constexpr double kSide = 4;  // [m] of a chart

/// A chart in a square of its own color with one triangle at a height.
void AddChart(double height, int column, int from, uchar color, TriangleMesh& mesh,
              GroundTexture& texture) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 3; ++i) mesh.vertices.emplace_back(0.0F, 0.0F, static_cast<float>(height));
  mesh.triangles.push_back({first, first + 1, first + 2});
  TextureChart chart;
  chart.left = column * kSide, chart.top = kSide, chart.column = column;
  const int size = static_cast<int>(kSide / texture.texel_size);
  chart.image = cv::Mat(size, size, CV_8UC3, cv::Scalar::all(color));
  chart.mask = cv::Mat(size, size, CV_8UC1, cv::Scalar(0));
  chart.mask.rowRange(from, from + 5) = 255;
  chart.triangles = {static_cast<std::uint32_t>(mesh.triangles.size() - 1)};
  texture.charts.push_back(std::move(chart));
}

uchar ColorAt(const GroundTile& tile, const Eigen::Vector2d& place) {
  const int column = static_cast<int>((place.x() - tile.left) / tile.pixel_size);
  const int row = static_cast<int>((tile.top - place.y()) / tile.pixel_size);
  return tile.mask.at<uchar>(row, column) == GroundTile::kSure
             ? tile.image.at<cv::Vec3b>(row, column)[0]
             : uchar{0};
}

/// Islands of drivable ground are charts of one square; what lies on them must not be found once
/// per island.
TEST(GroundTiles, HoldTheIslandsOfOneDeckTogether) {
  TriangleMesh mesh;
  GroundTexture texture;
  texture.texel_size = 0.1, texture.chart_size = kSide;
  AddChart(0.0, 0, 0, 50, mesh, texture);
  AddChart(0.1, 0, 20, 100, mesh, texture);
  AddChart(3.0, 0, 0, 150, mesh, texture);  // the deck above
  AddChart(0.2, 1, 20, 200, mesh, texture);
  const SurfaceMap surface;
  const GroundTiles tiles(mesh, surface, texture, 1.0);
  ASSERT_EQ(tiles.size(), 3U);
  const GroundTile lower = tiles.Make(0), upper = tiles.Make(1), next = tiles.Make(2);
  EXPECT_EQ(ColorAt(lower, {2, 3.8}), 50);
  EXPECT_EQ(ColorAt(lower, {2, 1.8}), 100);
  EXPECT_EQ(ColorAt(lower, {4.5, 1.8}), 200);  // in the margin
  EXPECT_EQ(ColorAt(upper, {2, 3.8}), 150);
  EXPECT_EQ(ColorAt(upper, {2, 1.8}), 0);
  EXPECT_EQ(ColorAt(next, {3.5, 1.8}), 100);
}

/// Paint fades with the texture's range; lines must not be taken to end there.
TEST(GroundTiles, AreSureOfNothingThatNoPhotoShows) {
  TriangleMesh mesh;
  GroundTexture texture;
  texture.texel_size = 0.1, texture.chart_size = kSide;
  AddChart(0.0, 0, 0, 50, mesh, texture);
  texture.charts[0].mask.colRange(20, 40).setTo(TextureChart::kPlain,
                                                texture.charts[0].mask.colRange(20, 40));
  const SurfaceMap surface;
  const GroundTile tile = GroundTiles(mesh, surface, texture, 1.0).Make(0);
  EXPECT_EQ(ColorAt(tile, {1, 3.8}), 50);
  EXPECT_EQ(ColorAt(tile, {3, 3.8}), 0);
  EXPECT_EQ(tile.mask.at<uchar>(12, 40), GroundTile::kUnsure);
  EXPECT_EQ(tile.image.at<cv::Vec3b>(12, 40)[0], 50);
}

}  // namespace
}  // namespace parkade
