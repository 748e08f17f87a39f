#include "mapping/mesh/thin_sheet.h"

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
VoxelSheet MakeGrid(std::uint32_t side, const std::function<double(double, double)>& height_at) {
  VoxelSheet sheet;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      sheet.vertices.emplace_back(kCell * x, kCell * y, height_at(kCell * x, kCell * y));
  for (std::uint32_t y = 0; y + 1 < side; ++y)
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t i = y * side + x;
      sheet.triangles.push_back({i, i + 1, i + side + 1});
      sheet.triangles.push_back({i, i + side + 1, i + side});
    }
  return sheet;
}

double Flat(double, double) { return 0; }

struct Thinned {
  VoxelSheet sheet;
  std::vector<std::uint32_t> left;
};

Thinned Thin(const VoxelSheet& sheet, const Colors& colors = {},
             const std::vector<bool>& is_kept = {}, const ThinSheetOptions& options = {}) {
  Thinned thinned{sheet, {}};
  const size_t count = sheet.vertices.size();
  thinned.left =
      ThinSheet(colors.empty() ? Colors(count, {90, 90, 90}) : colors,
                is_kept.empty() ? std::vector<bool>(count) : is_kept, options, thinned.sheet);
  return thinned;
}

/// Its area from above; every triangle faces up, every edge has one triangle on each side, or is
/// one of the border.
double CheckedArea(const VoxelSheet& sheet) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double sum = 0;
  for (const auto& triangle : sheet.triangles) {
    const Eigen::Vector3d a = sheet.vertices[triangle[0]], b = sheet.vertices[triangle[1]],
                          c = sheet.vertices[triangle[2]];
    const double area = 0.5 * (b - a).cross(c - a).z();
    EXPECT_GT(area, 0);
    sum += area;
    for (size_t i = 0; i < 3; ++i) ++edges[{triangle[i], triangle[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) EXPECT_EQ(count, 1);
  return sum;
}

/// [m] of the sheet at a place on it.
double HeightAt(const VoxelSheet& sheet, double x, double y) {
  for (const auto& triangle : sheet.triangles) {
    const Eigen::Vector3d a = sheet.vertices[triangle[0]], b = sheet.vertices[triangle[1]],
                          c = sheet.vertices[triangle[2]], at(x, y, 0);
    const double area = (b - a).cross(c - a).z();
    const double of_b = (at - a).cross(c - a).z() / area, of_c = (b - a).cross(at - a).z() / area;
    if (of_b >= -1e-9 && of_c >= -1e-9 && of_b + of_c <= 1 + 1e-9)
      return a.z() + of_b * (b - a).z() + of_c * (c - a).z();
  }
  ADD_FAILURE() << "nothing at " << x << ", " << y;
  return 0;
}

TEST(ThinSheet, LeavesLittleOfFlatGroundAndAllOfItsBorder) {
  const VoxelSheet grid = MakeGrid(61, Flat);
  const Thinned thinned = Thin(grid);
  EXPECT_LT(thinned.sheet.vertices.size(), grid.vertices.size() / 5);
  EXPECT_NEAR(CheckedArea(thinned.sheet), 36, 1e-9);
  const std::set<std::uint32_t> left(thinned.left.begin(), thinned.left.end());
  for (std::uint32_t i = 0; i < 61; ++i)
    for (const std::uint32_t at_border : {i, 61 * i, 61 * i + 60, 60 * 61 + i})
      EXPECT_TRUE(left.contains(at_border));
  for (size_t i = 0; i < thinned.left.size(); ++i)
    EXPECT_EQ(thinned.sheet.vertices[i], grid.vertices[thinned.left[i]]);
}

TEST(ThinSheet, LeavesEdgesAsLongAsAllowed) {
  const Thinned thinned = Thin(MakeGrid(61, Flat), {}, {}, {.max_edge = 0.3});
  ASSERT_GT(thinned.sheet.triangles.size(), 100u);
  for (const auto& triangle : thinned.sheet.triangles)
    for (size_t i = 0; i < 3; ++i)
      EXPECT_LE(
          (thinned.sheet.vertices[triangle[i]] - thinned.sheet.vertices[triangle[(i + 1) % 3]])
              .norm(),
          0.3 + 1e-9);
}

TEST(ThinSheet, KeepsTheShapeOfTheGround) {
  const auto hills = [](double x, double y) {
    return 0.05 * std::sin(1.5 * x) * std::cos(y) + 0.1 * x;
  };
  const Thinned thinned = Thin(MakeGrid(61, hills));
  EXPECT_LT(thinned.sheet.vertices.size(), 3000U);
  EXPECT_NEAR(CheckedArea(thinned.sheet), 36, 1e-9);
  for (double y = 0.05; y < 6; y += 0.31)
    for (double x = 0.05; x < 6; x += 0.37)
      EXPECT_NEAR(HeightAt(thinned.sheet, x, y), hills(x, y), 0.004);
}

TEST(ThinSheet, KeepsEdgesOfColorAndWhatIsToBeKept) {
  const VoxelSheet grid = MakeGrid(61, Flat);
  Colors colors(grid.vertices.size(), {90, 90, 90});
  std::vector<bool> is_kept(grid.vertices.size());
  for (size_t i = 0; i < colors.size(); ++i) {
    if (i % 61 >= 30) colors[i] = {230, 230, 230};  // a border of paint between columns 29 and 30
    is_kept[i] = i / 61 == 20;
  }
  const Thinned thinned = Thin(grid, colors, is_kept);
  const std::set<std::uint32_t> left(thinned.left.begin(), thinned.left.end());
  for (std::uint32_t i = 0; i < 61; ++i)
    for (const std::uint32_t vertex : {61 * i + 29, 61 * i + 30, 61 * 20 + i})
      EXPECT_TRUE(left.contains(vertex));
  EXPECT_LT(left.size(), 1200U);
}

TEST(ThinSheet, LeavesNothingAndLittleAsItIs) {
  EXPECT_TRUE(Thin({}).left.empty());
  const Thinned thinned = Thin(MakeGrid(2, Flat));
  EXPECT_EQ(thinned.left.size(), 4U);
  EXPECT_EQ(thinned.sheet.triangles.size(), 2U);
}

}  // namespace
}  // namespace parkade
