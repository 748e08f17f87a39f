#include "export/point_cloud.h"

#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <cmath>
#include <fstream>

#include "tests/export/example_map.h"

namespace parkade {
namespace {

TriangleMesh MakeSquare(double size) {
  TriangleMesh mesh;
  const auto edge = static_cast<float>(size);
  mesh.origin = {100, -50, 3};
  mesh.vertices = {{0, 0, 0}, {edge, 0, 0.1F * edge}, {edge, edge, 0.1F * edge}, {0, edge, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.normals.assign(4, Eigen::Vector3f::UnitZ());
  mesh.colors = {{0, 10, 20}, {200, 10, 20}, {200, 10, 20}, {0, 10, 20}};
  mesh.height_sigmas.assign(4, 0.01F);
  return mesh;
}

TEST(PointCloud, LiesOnTheMeshInItsColors) {
  const std::vector<ColoredPoint> points = SamplePoints(MakeSquare(2), 0.25);

  EXPECT_GE(points.size(), 8u * 8u);
  EXPECT_LE(points.size(), 9u * 9u + 9u);
  for (const ColoredPoint& point : points) {
    const double x = static_cast<double>(point.point_in_site.x()) - 100;
    EXPECT_NEAR(static_cast<double>(point.point_in_site.z()), 3 + 0.1 * x, 1e-4);
    EXPECT_NEAR(point.color[0], 100 * x, 1.0);
    EXPECT_EQ(point.color[1], 10);
  }
}

TEST(PointCloud, HasBothDecksOfAGarage) {
  const SiteMap map = MakeExampleMap(false);
  int below = 0, above = 0;
  for (const ColoredPoint& point : SamplePoints(map.mesh, 0.5)) {
    if (std::abs(point.point_in_site.x() - 10) > 4 || std::abs(point.point_in_site.y()) > 4)
      continue;
    (static_cast<double>(point.point_in_site.z()) > 0.5 * kUpperDeckHeight ? above : below)++;
  }
  EXPECT_GT(below, 100);
  EXPECT_GT(above, 100);
}

TEST(PointCloud, IsReadByPclAsWritten) {
  const std::vector<ColoredPoint> points = SamplePoints(MakeSquare(3), 0.1);
  const std::string file = testing::TempDir() + "point_cloud_test.pcd";
  std::ofstream(file, std::ios::binary) << EncodePcd(points);

  pcl::PointCloud<pcl::PointXYZRGB> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(file, cloud), 0);

  ASSERT_EQ(cloud.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(cloud[i].getVector3fMap(), points[i].point_in_site);
    EXPECT_EQ(cloud[i].r, points[i].color[0]);
    EXPECT_EQ(cloud[i].g, points[i].color[1]);
    EXPECT_EQ(cloud[i].b, points[i].color[2]);
  }
}

}  // namespace
}  // namespace parkade
