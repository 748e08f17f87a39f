#include "mapping/mesh/decimate_flat.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <set>

namespace parkade {
namespace {

using Colors = std::vector<std::array<std::uint8_t, 3>>;

constexpr double kCell = 0.1;  // [m]

/// A grid of `side` x `side` vertices, with all diagonals alike.
HeightMesh MakeGrid(std::uint32_t side, const std::function<double(double, double)>& height_at) {
  HeightMesh mesh;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      mesh.vertices.emplace_back(kCell * x, kCell * y, height_at(kCell * x, kCell * y));
  for (std::uint32_t y = 0; y + 1 < side; ++y)
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t i = y * side + x;
      mesh.triangles.push_back({i, i + 1, i + side + 1});
      mesh.triangles.push_back({i, i + side + 1, i + side});
    }
  return mesh;
}

double Flat(double, double) { return 0; }

struct Decimated {
  HeightMesh mesh;
  std::vector<std::uint32_t> left;
};

Decimated Decimate(const HeightMesh& mesh, const Colors& colors = {},
                   const std::vector<bool>& is_kept = {}, const DecimateFlatOptions& options = {}) {
  Decimated decimated{mesh, {}};
  const size_t count = mesh.vertices.size();
  decimated.left =
      DecimateFlat(colors.empty() ? Colors(count, {90, 90, 90}) : colors,
                   is_kept.empty() ? std::vector<bool>(count) : is_kept, options, decimated.mesh);
  return decimated;
}

/// Its area from above; every triangle faces up, every edge has one triangle on each side, or is
/// one of the border.
double CheckedArea(const HeightMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double sum = 0;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[triangle[0]], b = mesh.vertices[triangle[1]],
                          c = mesh.vertices[triangle[2]];
    const double area = 0.5 * (b - a).cross(c - a).z();
    EXPECT_GT(area, 0);
    sum += area;
    for (size_t i = 0; i < 3; ++i) ++edges[{triangle[i], triangle[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) EXPECT_EQ(count, 1);
  return sum;
}

/// [m] of the mesh at a place on it.
double HeightAt(const HeightMesh& mesh, double x, double y) {
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[triangle[0]], b = mesh.vertices[triangle[1]],
                          c = mesh.vertices[triangle[2]], at(x, y, 0);
    const double area = (b - a).cross(c - a).z();
    const double of_b = (at - a).cross(c - a).z() / area, of_c = (b - a).cross(at - a).z() / area;
    if (of_b >= -1e-9 && of_c >= -1e-9 && of_b + of_c <= 1 + 1e-9)
      return a.z() + of_b * (b - a).z() + of_c * (c - a).z();
  }
  ADD_FAILURE() << "nothing at " << x << ", " << y;
  return 0;
}

TEST(DecimateFlat, LeavesLittleOfFlatGroundAndAllOfItsBorder) {
  const HeightMesh grid = MakeGrid(61, Flat);
  const Decimated decimated = Decimate(grid);
  EXPECT_LT(decimated.mesh.vertices.size(), grid.vertices.size() / 5);
  EXPECT_NEAR(CheckedArea(decimated.mesh), 36, 1e-9);
  const std::set<std::uint32_t> left(decimated.left.begin(), decimated.left.end());
  for (std::uint32_t i = 0; i < 61; ++i)
    for (const std::uint32_t at_border : {i, 61 * i, 61 * i + 60, 60 * 61 + i})
      EXPECT_TRUE(left.contains(at_border));
  for (size_t i = 0; i < decimated.left.size(); ++i)
    EXPECT_EQ(decimated.mesh.vertices[i], grid.vertices[decimated.left[i]]);
}

TEST(DecimateFlat, LeavesEdgesAsLongAsAllowed) {
  const Decimated decimated = Decimate(MakeGrid(61, Flat), {}, {}, {.max_edge = 0.3});
  ASSERT_GT(decimated.mesh.triangles.size(), 100u);
  for (const auto& triangle : decimated.mesh.triangles)
    for (size_t i = 0; i < 3; ++i)
      EXPECT_LE(
          (decimated.mesh.vertices[triangle[i]] - decimated.mesh.vertices[triangle[(i + 1) % 3]])
              .norm(),
          0.3 + 1e-9);
}

TEST(DecimateFlat, KeepsTheShapeOfTheGround) {
  const auto hills = [](double x, double y) {
    return 0.05 * std::sin(1.5 * x) * std::cos(y) + 0.1 * x;
  };
  const Decimated decimated = Decimate(MakeGrid(61, hills));
  EXPECT_LT(decimated.mesh.vertices.size(), 3000U);
  EXPECT_NEAR(CheckedArea(decimated.mesh), 36, 1e-9);
  for (double y = 0.05; y < 6; y += 0.31)
    for (double x = 0.05; x < 6; x += 0.37)
      EXPECT_NEAR(HeightAt(decimated.mesh, x, y), hills(x, y), 0.004);
}

TEST(DecimateFlat, KeepsEdgesOfColorAndWhatIsToBeKept) {
  const HeightMesh grid = MakeGrid(61, Flat);
  Colors colors(grid.vertices.size(), {90, 90, 90});
  std::vector<bool> is_kept(grid.vertices.size());
  for (size_t i = 0; i < colors.size(); ++i) {
    if (i % 61 >= 30) colors[i] = {230, 230, 230};  // a border of paint between columns 29 and 30
    is_kept[i] = i / 61 == 20;
  }
  const Decimated decimated = Decimate(grid, colors, is_kept);
  const std::set<std::uint32_t> left(decimated.left.begin(), decimated.left.end());
  for (std::uint32_t i = 0; i < 61; ++i)
    for (const std::uint32_t vertex : {61 * i + 29, 61 * i + 30, 61 * 20 + i})
      EXPECT_TRUE(left.contains(vertex));
  EXPECT_LT(left.size(), 1200U);
}

TEST(DecimateFlat, LeavesNothingAndLittleAsItIs) {
  EXPECT_TRUE(Decimate({}).left.empty());
  const Decimated decimated = Decimate(MakeGrid(2, Flat));
  EXPECT_EQ(decimated.left.size(), 4U);
  EXPECT_EQ(decimated.mesh.triangles.size(), 2U);
}

}  // namespace
}  // namespace parkade
