#include "export/gltf/tile_levels.h"

#include <gtest/gtest.h>

#include <map>
#include <opencv2/core.hpp>
#include <set>
#include <tuple>

#include "export/gltf/merge_vertices.h"
#include "tests/export/example_map.h"

namespace parkade {
namespace {

struct MapLevel {
  double error = 0;
  std::vector<MapTile> tiles;
};

std::vector<MapLevel> LevelsOf(const TriangleMesh& mesh, const GroundTexture& texture,
                               double square_size) {
  std::vector<MapLevel> levels;
  VisitTiles(mesh, texture, square_size, 0.5, [&](const MapTile& tile) {
    const auto level = static_cast<size_t>(tile.level);
    if (level >= levels.size()) levels.resize(level + 1);
    levels[level].error = tile.error;
    levels[level].tiles.push_back(tile);
  });
  return levels;
}

std::vector<MapLevel> LevelsOf(const SiteMap& map) { return LevelsOf(map.mesh, map.texture, 8); }

size_t NumTriangles(const MapLevel& level) {
  size_t count = 0;
  for (const MapTile& tile : level.tiles) count += tile.mesh.triangles.size();
  return count;
}

TEST(TileLevels, EachIsCoarserAndTheLastIsOneTile) {
  const SiteMap map = MakeExampleMap(false);
  const std::vector<MapLevel> levels = LevelsOf(map);
  ASSERT_GE(levels.size(), 4U);  // 40 m in squares of 8 m: 8, 16, 32, 64 m
  EXPECT_EQ(NumTriangles(levels[0]), map.mesh.triangles.size());
  EXPECT_EQ(levels[0].error, 0);
  for (size_t i = 1; i < levels.size(); ++i) {
    EXPECT_LT(NumTriangles(levels[i]), NumTriangles(levels[i - 1]));
    EXPECT_LT(levels[i].tiles.size(), levels[i - 1].tiles.size());
    EXPECT_GT(levels[i].error, levels[i - 1].error);
    for (const MapTile& tile : levels[i].tiles) ValidateMesh(tile.mesh);
  }
  EXPECT_EQ(levels.back().tiles.size(), 1U);
}

TEST(TileLevels, ATileComesAfterAllThatItTakesThePlaceOf) {
  const SiteMap map = MakeTexturedMap();
  std::set<std::tuple<int, int, int>> visited;  // level, row, column
  int num_coarsest = 0;
  VisitTiles(map.mesh, map.texture, 8, 0.5, [&](const MapTile& tile) {
    visited.emplace(tile.level, tile.row, tile.column);
    EXPECT_FALSE(visited.contains({tile.level + 1, tile.row / 2, tile.column / 2}));
    num_coarsest += tile.is_coarsest;
  });
  EXPECT_EQ(num_coarsest, 1);
}

TEST(TileLevels, ASmallMapHasAnOverviewToo) {
  const SiteMap map = MakeExampleMap(false);
  EXPECT_EQ(LevelsOf(map.mesh, {}, 1000).size(), 2U);
  EXPECT_TRUE(LevelsOf({}, {}, 8).empty());
}

TEST(TileLevels, NeighborsOfOneLevelShareTheirVertices) {
  const SiteMap map = MakeExampleMap(false);
  for (const MapLevel& level : LevelsOf(map)) {
    // Where two tiles have a vertex of the site's mesh they have it at the same place: places are
    // as many as vertices.
    std::set<std::tuple<double, double, double>> places;
    std::set<std::tuple<long, long, long>> centimeters;
    for (const MapTile& tile : level.tiles)
      for (const Eigen::Vector3f& vertex : tile.mesh.vertices) {
        const Eigen::Vector3d place = tile.mesh.origin + vertex.cast<double>();
        places.emplace(place.x(), place.y(), place.z());
        centimeters.emplace(std::lround(100 * place.x()), std::lround(100 * place.y()),
                            std::lround(100 * place.z()));
      }
    EXPECT_EQ(places.size(), centimeters.size());
    EXPECT_FALSE(places.empty());
  }
}

TEST(TileLevels, PicturesStayWhereTheyAre) {
  const SiteMap map =
      MakeTexturedMap();  // red is the column and green the row of an image of 50 m x 30 m
  const std::vector<MapLevel> levels = LevelsOf(map);
  ASSERT_GE(levels.size(), 3U);
  for (const MapLevel& level : levels)
    for (const MapTile& tile : level.tiles) {
      size_t painted = 0;
      for (const TextureChart& chart : tile.texture.charts) {
        painted += chart.triangles.size();
        const double texel = tile.texture.texel_size;
        for (int row = 0; row + 1 < chart.image.rows; row += 7)
          for (int column = 0; column + 1 < chart.image.cols; column += 7) {
            const double x = chart.left + (column + 0.5) * texel,
                         y = chart.top - (row + 0.5) * texel;
            const auto& color = chart.image.at<cv::Vec3b>(row, column);
            EXPECT_NEAR(color[2], 255 * (x + 25) / 50, 1.5 + 255 * texel / 50);
            EXPECT_NEAR(color[1], 255 * (15 - y) / 30, 1.5 + 255 * texel / 30);
          }
      }
      EXPECT_EQ(painted, tile.mesh.triangles.size());
    }
  EXPECT_LE(levels.back().tiles[0].texture.charts[0].image.cols, 500 / 4 + 1);
}

TEST(TileLevels, GroundThatNoPhotoShowsIsGround) {
  const SiteMap painted = MakeTexturedMap();
  SiteMap plain = MakeTexturedMap();
  for (TextureChart& chart : plain.texture.charts)
    chart.mask.setTo(TextureChart::kPlain, chart.mask);
  const auto coarsest_mask = [](const SiteMap& map) -> cv::Mat {
    return LevelsOf(map).back().tiles[0].texture.charts[0].mask != 0;
  };
  const cv::Mat one = coarsest_mask(painted), other = coarsest_mask(plain);
  ASSERT_EQ(one.size(), other.size());
  EXPECT_EQ(cv::countNonZero(one != other), 0);
  EXPECT_GT(cv::countNonZero(other), 0);
}

TEST(MergeVertices, MovesNoVertexFurtherThanItsCubeIsLong) {
  const TriangleMesh mesh = MakeExampleMap(false).mesh;
  const std::vector<std::uint32_t> representative = MergeVertices(mesh, 0.5);
  ASSERT_FALSE(mesh.vertices.empty());
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    EXPECT_LT((mesh.vertices[representative[i]] - mesh.vertices[i]).norm(), 0.5 * std::sqrt(3.0));
}

TEST(MergeVertices, DecksStayApart) {
  const TriangleMesh mesh = MakeExampleMap(false).mesh;
  const std::vector<std::uint32_t> representative = MergeVertices(mesh, 16);
  ASSERT_FALSE(mesh.vertices.empty());
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    EXPECT_LE(std::abs(mesh.vertices[representative[i]].z() - mesh.vertices[i].z()), 1);
}

TEST(MergeVertices, OutlinesStayOutlines) {
  // A square of 2 m with one vertex inside, all in one cube: a corner stands for it.
  TriangleMesh mesh;
  mesh.vertices = {{0.1F, 0.1F, 0}, {1.9F, 0.1F, 0}, {1.9F, 1.9F, 0}, {0.1F, 1.9F, 0}, {1, 1, 0}};
  mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const std::vector<std::uint32_t> representative = MergeVertices(mesh, 2);
  ASSERT_EQ(representative.size(), 5U);
  for (const std::uint32_t vertex : representative) EXPECT_NE(vertex, 4U);
}

}  // namespace
}  // namespace parkade
