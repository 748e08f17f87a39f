#include "export/occupancy_grid.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "tests/export/example_map.h"

namespace parkade {
namespace {

cv::Mat Decode(const OccupancyGrid& grid) {
  return cv::imdecode(std::vector<char>(grid.pgm.begin(), grid.pgm.end()), cv::IMREAD_UNCHANGED);
}

/// The value at a place, found as map_server does: the origin is the outer corner of the lower left
/// cell.
int ValueAt(const OccupancyGrid& grid, double x, double y) {
  const YAML::Node yaml = YAML::Load(grid.yaml);
  const cv::Mat image = Decode(grid);
  const double resolution = yaml["resolution"].as<double>();
  const int column =
      static_cast<int>(std::floor((x - yaml["origin"][0].as<double>()) / resolution));
  const int row = image.rows - 1 -
                  static_cast<int>(std::floor((y - yaml["origin"][1].as<double>()) / resolution));
  return cv::Rect(0, 0, image.cols, image.rows).contains({column, row})
             ? image.at<std::uint8_t>(row, column)
             : -1;
}

/// 3 m x 2 m from (-1.5, 0.5).
TriangleMesh MakeRectangle() {
  TriangleMesh mesh;
  mesh.origin = {-1.5, 0.5, 0};
  mesh.vertices = {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.normals.assign(4, Eigen::Vector3f::UnitZ());
  mesh.colors.assign(4, {});
  mesh.height_sigmas.assign(4, 0);
  return mesh;
}

TEST(OccupancyGrids, AreFreeWhereTheMeshIsAndUnknownElsewhere) {
  const OccupancyGrid grid = MakeOccupancyGrid(MakeRectangle(), "map.pgm");

  EXPECT_EQ(YAML::Load(grid.yaml)["image"].as<std::string>(), "map.pgm");
  EXPECT_EQ(Decode(grid).size(), cv::Size(60, 40));
  for (const double x : {-1.48, 0.0, 1.48})
    for (const double y : {0.52, 1.5, 2.48}) EXPECT_EQ(ValueAt(grid, x, y), 254) << x << " " << y;
  const OccupancyGrid garage = MakeOccupancyGrid(MakeExampleMap(false).mesh, "map.pgm");
  const cv::Mat image = Decode(garage);
  EXPECT_GT(cv::countNonZero(image == 205), 0);
  EXPECT_EQ(cv::countNonZero(image == 205) + cv::countNonZero(image == 254),
            image.rows * image.cols);
}

TEST(OccupancyGrids, CanBeOfOneDeck) {
  const TriangleMesh mesh = MakeExampleMap(false).mesh;
  OccupancyGridOptions lower, upper;
  lower.highest = 0.5;
  upper.lowest = kUpperDeckHeight - 0.5;

  // The upper deck lies above the east half of the lower one.
  EXPECT_EQ(ValueAt(MakeOccupancyGrid(mesh, "a", lower), -15, 5), 254);
  EXPECT_NE(ValueAt(MakeOccupancyGrid(mesh, "a", upper), -15, 5), 254);
  EXPECT_EQ(ValueAt(MakeOccupancyGrid(mesh, "a", upper), 15, 5), 254);
}

TEST(OccupancyGrids, OfNothingOrOfTooMuchAreRefused) {
  OccupancyGridOptions sky;
  sky.lowest = 100;
  EXPECT_THROW(MakeOccupancyGrid(MakeRectangle(), "a", sky), Error);
  EXPECT_THROW(MakeOccupancyGrid({}, "a"), Error);
  OccupancyGridOptions none;
  none.resolution = 0;
  EXPECT_THROW(MakeOccupancyGrid(MakeRectangle(), "a", none), Error);
}

}  // namespace
}  // namespace parkade
