#include "mapping/mesh/mesh_surface.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "mapping/ground/surface_links.h"
#include "mapping/mesh/height_mesh.h"
#include "mapping/mesh/simplify_mesh.h"
#include "mapping/surface/join_cells.h"
#include "tests/mapping/worlds/test_surfaces.h"

namespace parkade {
namespace {

class HeightMeshOf : public testing::TestWithParam<double> {};

TEST_P(HeightMeshOf, ASlopeLiesOnItAndIsAManifold) {
  const double slope = GetParam();
  const auto height = [&](double x, double y) { return 0.125 + slope * x - 0.3 * slope * y; };
  const SurfaceMap surface = MakeSurface(30, 20, 0.1, height);

  const HeightMesh mesh = TriangulateHeights(surface, 0.5);

  ASSERT_EQ(mesh.triangles.size(), 29u * 19u * 2u);
  for (const Eigen::Vector3d& vertex : mesh.vertices)
    EXPECT_NEAR(vertex.z(), height(vertex.x(), vertex.y()), 1e-6);
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d normal =
        (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    EXPECT_GT(normal.z(), -1e-12) << "counter-clockwise seen from above";
    area += 0.5 * normal.z();
  }
  EXPECT_NEAR(area, 2.9 * 1.9, 1e-6);
  for (const auto& [edge, count] : CountDirectedEdges(mesh.triangles)) EXPECT_EQ(count, 1);
}

INSTANTIATE_TEST_SUITE_P(Slopes, HeightMeshOf, testing::Values(0.0, 0.02, 0.15, 0.4, -0.15));

TEST(HeightMesh, VerticesWhereOnlyCornersTouchAreDoubled) {
  // Two blocks of cells that share one cell in the middle.
  SurfaceMap surface{0.1, {}};
  for (const SurfaceCell& cell : MakeSurface(7, 7, 0.1, [](double, double) { return 0.0; }).cells)
    if ((cell.x <= 3 && cell.y <= 3) || (cell.x >= 3 && cell.y >= 3)) surface.cells.push_back(cell);

  const HeightMesh mesh = TriangulateHeights(surface, 0.3);

  EXPECT_EQ(mesh.vertices.size(), 32u);
  EXPECT_EQ(mesh.triangles.size(), 36u);
}

TEST(SurfaceLinks, JoinTheNearestHeightAndNoOther) {
  SurfaceMap surface{0.1,
                     {{.x = 0, .y = 0, .height = 0},
                      {.x = 0, .y = 0, .height = 3},
                      {.x = 1, .y = 0, .height = 2.95F},
                      {.x = 2, .y = 0, .height = 1}}};

  const SurfaceLinks links = LinkCells(surface, 0.3);

  EXPECT_EQ(links.right, (std::vector<int>{-1, 2, -1, -1}));
  EXPECT_EQ(links.left, (std::vector<int>{-1, -1, 1, -1}));
}

TEST(JoinCells, TheBeliefIsTheShareThatIsFree) {
  SurfaceMap surface{0.05,
                     {{.x = 0, .y = 0, .height = 1, .free_belief = 1},
                      {.x = 1, .y = 0, .height = 1, .free_belief = 1},
                      {.x = 0, .y = 1, .height = 1, .free_belief = 0.5F}}};

  const SurfaceMap joined = JoinCells(surface, 2, 0.5, 0.3);

  ASSERT_EQ(joined.cells.size(), 9u) << "and what lies around it";
  EXPECT_DOUBLE_EQ(joined.cell_size, 0.1);
  for (const SurfaceCell& cell : joined.cells)
    EXPECT_FLOAT_EQ(cell.free_belief, cell.x == 0 && cell.y == 0 ? 2.5F / 4 : 0);
}

TEST(JoinCells, TheSlopeGoesOnBeyondTheLastCell) {
  const SurfaceMap surface = MakeSurface(8, 8, 0.05, [](double x, double) { return 0.2 * x; });

  for (const SurfaceCell& cell : JoinCells(surface, 2, 0.5, 0.3).cells)
    if (cell.y >= 0 && cell.y < 4) {
      EXPECT_NEAR(cell.height, 0.2 * 0.1 * (cell.x + 0.5), 1e-5) << cell.x;
    }
}

TEST(JoinCells, NegativeCellsJoinWithTheirOwn) {
  SurfaceMap surface{0.05,
                     {{.x = -2, .y = -1, .free_belief = 1},
                      {.x = -1, .y = -1, .free_belief = 1},
                      {.x = 0, .y = -1, .free_belief = 1},
                      {.x = 1, .y = -1, .free_belief = 1}}};

  std::vector<Eigen::Vector2i> free;
  for (const SurfaceCell& cell : JoinCells(surface, 2, 0.5, 0.3).cells)
    if (cell.free_belief > 0) free.emplace_back(cell.x, cell.y);

  EXPECT_EQ(free, (std::vector<Eigen::Vector2i>{{-1, -1}, {0, -1}}));
}

/// [m^2] of the mesh of a surface of `size` x `size` cells of 5 cm that is free where `is_free`
/// says.
double MeshAreaOf(int size, const std::function<bool(double, double)>& is_free) {
  SurfaceMap surface = MakeSurface(size, size, 0.05, [](double, double) { return 0.0; });
  for (SurfaceCell& cell : surface.cells)
    cell.free_belief = is_free((cell.x + 0.5) * 0.05, (cell.y + 0.5) * 0.05) ? 0.999F : 0.001F;
  const TriangleMesh mesh = MeshSurface(surface);
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    area +=
        0.5 *
        static_cast<double>(
            (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).z());
  return area;
}

TEST(MeshSurface, AnOutlineLiesWhereTheCellsPutIt) {
  // Neither grows nor shrinks, whatever its direction and however it meets the joined cells.
  for (const double edge : {4.0, 4.05, 4.1})
    EXPECT_NEAR(MeshAreaOf(160, [&](double x, double) { return x < edge; }) / 8, edge, 0.02)
        << edge;
  EXPECT_NEAR(MeshAreaOf(160, [](double x, double y) { return x + 0.4 * y < 6; }), 8 * 6 - 0.4 * 32,
              0.15);
  const auto outside_pillar = [](double x, double y) {
    return std::abs(x - 4) > 0.25 || std::abs(y - 4) > 0.25;
  };
  EXPECT_NEAR(64 - MeshAreaOf(160, outside_pillar), 0.25, 0.06);
}

HeightMesh SimplifyMesh(const HeightMesh& mesh,
                        const std::vector<std::array<std::uint8_t, 3>>& colors,
                        const SimplifyMeshOptions& options) {
  HeightMesh joined;
  JoinPieces(SimplifyPieces(mesh, colors, options), joined);
  return joined;
}

TEST(SimplifyMesh, AFlatMeshOfOneColorNeedsFewTriangles) {
  const HeightMesh mesh =
      TriangulateHeights(MakeSurface(200, 200, 0.1, [](double, double) { return 0.0; }), 0.3);
  const std::vector<std::array<std::uint8_t, 3>> gray(mesh.vertices.size(), {90, 90, 90});

  const HeightMesh simple = SimplifyMesh(mesh, gray, {});

  EXPECT_LT(simple.triangles.size(), mesh.triangles.size() / 10);
  double area = 0;
  for (const auto& [a, b, c] : simple.triangles)
    area += 0.5 * (simple.vertices[b] - simple.vertices[a])
                      .cross(simple.vertices[c] - simple.vertices[a])
                      .z();
  EXPECT_NEAR(area, 19.9 * 19.9, 0.5) << "the border keeps its course";
  for (const auto& [edge, count] : CountDirectedEdges(simple.triangles)) EXPECT_EQ(count, 1);
}

TEST(SimplifyMesh, HeightsStayWithinTheBound) {
  const auto height = [](double x, double y) {
    return 0.3 * std::sin(0.4 * x) * std::cos(0.3 * y);
  };
  const HeightMesh mesh = TriangulateHeights(MakeSurface(150, 150, 0.1, height), 0.3);
  const std::vector<std::array<std::uint8_t, 3>> gray(mesh.vertices.size(), {90, 90, 90});

  const HeightMesh simple = SimplifyMesh(mesh, gray, {.max_error = 0.01});

  EXPECT_LT(simple.triangles.size(), mesh.triangles.size() / 3);
  for (const auto& [a, b, c] : simple.triangles) {
    const Eigen::Vector3d center =
        (simple.vertices[a] + simple.vertices[b] + simple.vertices[c]) / 3;
    EXPECT_NEAR(center.z(), height(center.x(), center.y()), 0.02);
  }
}

TEST(SimplifyMesh, ALineOfPaintKeepsItsPlace) {
  const HeightMesh mesh =
      TriangulateHeights(MakeSurface(100, 100, 0.1, [](double, double) { return 0.0; }), 0.3);
  std::vector<std::array<std::uint8_t, 3>> colors;
  for (const Eigen::Vector3d& vertex : mesh.vertices)
    colors.push_back(std::abs(vertex.x() - 5.05) < 0.01 ? std::array<std::uint8_t, 3>{220, 220, 220}
                                                        : std::array<std::uint8_t, 3>{90, 90, 90});

  const HeightMesh simple = SimplifyMesh(mesh, colors, {});

  const auto on_line = [](const Eigen::Vector3d& vertex) {
    return std::abs(vertex.x() - 5.05) < 1e-6;
  };
  EXPECT_EQ(std::count_if(simple.vertices.begin(), simple.vertices.end(), on_line), 100);
}

TEST(MeshSurface, HoldsWhatAMeshPromises) {
  const SurfaceMap surface =
      MakeSurface(120, 80, 0.05, [](double x, double y) { return 40 + 0.1 * x + 0.02 * y; });

  const TriangleMesh mesh = MeshSurface(surface);

  EXPECT_NO_THROW(ValidateMesh(mesh));
  EXPECT_NEAR(SurfaceArea(mesh), 6.0 * 4.0 * std::sqrt(1 + 0.01 + 0.0004), 0.1);
  const Eigen::Vector3f up = Eigen::Vector3d(-0.1, -0.02, 1).normalized().cast<float>();
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_NEAR(mesh.normals[i].norm(), 1, 1e-5);
    EXPECT_GT(mesh.normals[i].dot(up), 0.99F);
    EXPECT_EQ(mesh.colors[i][0], 100);
    EXPECT_FLOAT_EQ(mesh.height_sigmas[i], 0.02F);
    const Eigen::Vector3d point = mesh.vertices[i].cast<double>() + mesh.origin;
    EXPECT_NEAR(point.z(), 40 + 0.1 * point.x() + 0.02 * point.y(), 2e-3);
  }
}

/// Two decks above each other and a ramp between them, 64 m x 30 m about the origin, with painted
/// lines, pillars, ragged outlines, and places where free ground touches in corners only.
SurfaceMap MakeTwoDecks() {
  SurfaceMap surface{0.1, {}};
  for (int y = -150; y < 150; ++y)
    for (int x = -320; x < 320; ++x) {
      const auto noise =
          static_cast<std::uint32_t>((x + 1000) * 7919 + (y + 1000) * 104729) * 2654435761U >> 24;
      const bool is_line = x % 25 == 0 && y > 40;
      const bool is_pillar = x % 120 < 3 && y % 80 < 3;
      const bool is_chequered = std::abs(x) < 20 && y < -100;
      SurfaceCell cell{
          .x = x,
          .y = y,
          .height = 0.004F * static_cast<float>(y) + 0.0001F * static_cast<float>(noise),
          .height_sigma = 0.01F + 0.0001F * static_cast<float>(noise),
          .free_belief = is_pillar || (is_chequered && (x / 4 + y / 4) % 2 == 0) ? 0.1F : 0.9F,
          .color = {100, 100, static_cast<std::uint8_t>(is_line ? 220 : 90 + noise / 16)}};
      if (y > 135 && noise > 120) cell.free_belief = 0.3F;
      surface.cells.push_back(cell);
      // The upper deck, and the ramp that leaves the lower one.
      if (std::abs(y) > 100 || x < -200) continue;
      cell.height =
          x < 0 ? 0.015F * static_cast<float>(x + 200) + 0.004F * static_cast<float>(y) : 3;
      if (x < -120 && std::abs(y) <= 100) cell.free_belief = 0;
      if (cell.height - surface.cells.back().height > 1.5F) surface.cells.push_back(cell);
    }
  return surface;
}

TEST(MeshSurface, TheWindowsLeaveNoTrace) {
  const SurfaceMap surface = MakeTwoDecks();
  MeshOptions options;
  options.window_size = 1000;
  const TriangleMesh whole = MeshSurface(surface, options);
  ASSERT_GT(whole.triangles.size(), 5000u);
  for (const double window_size : {24.0, 12.0}) {
    options.window_size = window_size;
    const TriangleMesh cut = MeshSurface(surface, options);
    ASSERT_EQ(cut.vertices.size(), whole.vertices.size()) << window_size;
    EXPECT_EQ(cut.triangles, whole.triangles);
    EXPECT_EQ(cut.origin, whole.origin);
    EXPECT_EQ(cut.vertices, whole.vertices);
    EXPECT_EQ(cut.normals, whole.normals);
    EXPECT_EQ(cut.colors, whole.colors);
    EXPECT_EQ(cut.height_sigmas, whole.height_sigmas);
  }
}

TEST(MeshSurface, SeamsOfWindowsHaveNoCracks) {
  // A plain without holes: but for its rim, each edge has its triangle on the other side.
  const SurfaceMap surface =
      MakeSurface(500, 260, 0.1, [](double x, double y) { return 0.02 * x + 0.1 * std::sin(y); });
  MeshOptions options;
  options.window_size = 12;
  const TriangleMesh mesh = MeshSurface(surface, options);
  ASSERT_FALSE(mesh.empty());
  const auto edges = CountDirectedEdges(mesh.triangles);
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    if (edges.contains({edge.second, edge.first})) continue;
    for (const std::uint32_t vertex : {edge.first, edge.second}) {
      const Eigen::Vector3d at = mesh.origin + mesh.vertices[vertex].cast<double>();
      EXPECT_LT(std::min({at.x(), at.y(), 50 - at.x(), 26 - at.y()}), 0.3) << at.transpose();
    }
  }
}

TEST(MeshSurface, NothingFreeGivesNoMesh) {
  SurfaceMap surface = MakeSurface(20, 20, 0.05, [](double, double) { return 0.0; });
  for (SurfaceCell& cell : surface.cells) cell.free_belief = 0.3F;

  EXPECT_TRUE(MeshSurface(surface).empty());
  EXPECT_TRUE(MeshSurface(SurfaceMap{}).empty());
}

TEST(MeshSurface, RejectsAThresholdThatNothingPasses) {
  MeshOptions options;
  options.free_threshold = 1;
  EXPECT_THROW(MeshSurface({}, options), Error);
}

}  // namespace
}  // namespace parkade
