#include "mapping/evaluation/evaluate_surface.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "mapping/mesh/read_ply.h"
#include "tests/mapping/worlds/test_surfaces.h"

namespace parkade {
namespace {

TriangleMesh Rectangle(double x0, double y0, double x1, double y1, double z) {
  TriangleMesh mesh;
  AddRectangle(mesh, x0, y0, x1, y1, z);
  return mesh;
}

TEST(EvaluateSurface, TheSameSurfaceIsPerfect) {
  const TriangleMesh mesh = Rectangle(0, 0, 20, 10, 1);

  const SurfaceEvaluation evaluation = EvaluateSurface(mesh, mesh);

  EXPECT_NEAR(evaluation.height_rmse, 0, 1e-6);
  EXPECT_DOUBLE_EQ(evaluation.completeness_percent, 100);
  EXPECT_DOUBLE_EQ(evaluation.false_free_percent, 0);
  EXPECT_DOUBLE_EQ(evaluation.iou, 1);
  EXPECT_DOUBLE_EQ(evaluation.boundary_iou, 1);
  EXPECT_NEAR(evaluation.truth_area, 200, 4);
}

TEST(EvaluateSurface, AShiftInHeightIsTheErrorOfHeight) {
  const SurfaceEvaluation evaluation =
      EvaluateSurface(Rectangle(0, 0, 20, 10, 1), Rectangle(0, 0, 20, 10, 1.07));

  EXPECT_NEAR(evaluation.height_rmse, 0.07, 1e-4);
  EXPECT_NEAR(evaluation.height_bias, 0.07, 1e-4);
  EXPECT_NEAR(evaluation.height_p95, 0.07, 1e-4);
  EXPECT_NEAR(evaluation.accuracy_rmse, 0.07, 1e-4);
}

TEST(EvaluateSurface, HalfASurfaceIsHalfComplete) {
  const SurfaceEvaluation evaluation =
      EvaluateSurface(Rectangle(0, 0, 20, 10, 0), Rectangle(0, 0, 10, 10, 0));

  EXPECT_NEAR(evaluation.completeness_percent, 51, 1) << "and what lies within 20 cm of it";
  EXPECT_NEAR(evaluation.iou, 0.5, 0.01);
  EXPECT_DOUBLE_EQ(evaluation.false_free_percent, 0);
}

TEST(EvaluateSurface, GroundThatIsNoneIsFalseAndInaccurate) {
  const SurfaceEvaluation evaluation =
      EvaluateSurface(Rectangle(0, 0, 20, 10, 0), Rectangle(0, 0, 25, 10, 0));

  EXPECT_NEAR(evaluation.false_free_percent, 20, 0.5);
  EXPECT_GT(evaluation.accuracy_rmse, 0.3);
  EXPECT_NEAR(evaluation.completeness_percent, 100, 1e-9);
}

TEST(EvaluateSurface, BoundaryIouSeesWhatIouDoesNot) {
  // 30 cm less on each side of a big lot.
  const SurfaceEvaluation evaluation =
      EvaluateSurface(Rectangle(0, 0, 60, 60, 0), Rectangle(0.3, 0.3, 59.7, 59.7, 0));

  EXPECT_GT(evaluation.iou, 0.97);
  EXPECT_NEAR(evaluation.boundary_iou, 0.2 / 0.8, 0.1);
}

TEST(EvaluateSurface, DecksAreComparedEachWithItsOwn) {
  TriangleMesh truth = Rectangle(0, 0, 20, 10, 0), estimate = Rectangle(0, 0, 20, 10, 0.02);
  AddRectangle(truth, 0, 0, 20, 10, 3);
  AddRectangle(estimate, 0, 0, 20, 10, 2.98);

  const SurfaceEvaluation evaluation = EvaluateSurface(truth, estimate);

  EXPECT_NEAR(evaluation.height_rmse, 0.02, 1e-4);
  EXPECT_NEAR(evaluation.height_bias, 0, 1e-4);
  EXPECT_DOUBLE_EQ(evaluation.completeness_percent, 100);
}

TEST(EvaluateSurface, OnlyTheSurroundingsOfThePathCount) {
  SurfaceEvaluationOptions options;
  options.max_path_distance = 3;
  std::vector<Eigen::Vector3d> path;
  for (double x = 0; x <= 100; x += 0.5) path.push_back({x, 0, 0});

  const SurfaceEvaluation evaluation =
      EvaluateSurface(Rectangle(0, -20, 100, 20, 0), Rectangle(0, -3.5, 100, 3.5, 0), options,
                      {.path = path, .find_seen = {}});

  EXPECT_DOUBLE_EQ(evaluation.completeness_percent, 100);
  EXPECT_NEAR(evaluation.truth_area, 600, 15);
}

TEST(EvaluateSurface, TheEdgeOfTheScopeIsNoOutline) {
  SurfaceEvaluationOptions options;
  options.max_path_distance = 3;
  const std::vector<Eigen::Vector3d> path = {{0, 0, 0}, {2, 0, 0}};

  // Both reach far beyond the scope, where they differ; inside neither has an outline.
  const SurfaceEvaluation evaluation =
      EvaluateSurface(Rectangle(-50, -20, 50, 20, 0), Rectangle(-50, -10, 50, 30, 0), options,
                      {.path = path, .find_seen = {}});

  EXPECT_DOUBLE_EQ(evaluation.boundary_iou, 1);
  EXPECT_DOUBLE_EQ(evaluation.false_free_percent, 0);
}

TEST(EvaluateSurface, AMapThatEndsAtTheScopesLimitIsPerfect) {
  SurfaceEvaluationOptions options;
  options.max_path_distance = 12;
  std::vector<Eigen::Vector3d> path;
  for (double x = 0; x <= 60; x += 0.5) path.push_back({x, 0, 0});
  // A kerb on one side; on the other the ground goes on, and the map ends where the scope does.
  const TriangleMesh truth = Rectangle(-50, -40, 110, 6, 0);

  const SurfaceEvaluation perfect = EvaluateSurface(truth, Rectangle(-50, -12.1, 110, 6, 0),
                                                    options, {.path = path, .find_seen = {}});
  EXPECT_DOUBLE_EQ(perfect.boundary_iou, 1);
  EXPECT_DOUBLE_EQ(perfect.relative_boundary_iou, 1);
  const SurfaceEvaluation cut = EvaluateSurface(truth, Rectangle(-50, -11, 110, 6, 0), options,
                                                {.path = path, .find_seen = {}});
  EXPECT_NEAR(cut.boundary_iou, 0.5, 0.05) << "an end inside the scope is one";
}

TEST(EvaluateSurface, TheRelativeRimIsTwoPercentOfTheDiagonal) {
  const SurfaceEvaluation evaluation =
      EvaluateSurface(Rectangle(0, 0, 80, 60, 0), Rectangle(0.3, 0.3, 79.7, 59.7, 0));

  EXPECT_NEAR(evaluation.relative_boundary_width, 2, 1e-9);
  EXPECT_NEAR(evaluation.relative_boundary_iou, 1.7 / 2.3, 0.05);
}

TEST(EvaluateSurface, GroundThatNothingSawIsNeitherMissedNorFalse) {
  const SurfaceScope scope{{}, [](const std::vector<Eigen::Vector3d>& points) {
                             std::vector<bool> is_seen;
                             for (const Eigen::Vector3d& point : points)
                               is_seen.push_back(point.x() < 10);
                             return is_seen;
                           }};
  const TriangleMesh truth = Rectangle(0, 0, 20, 10, 0);

  const SurfaceEvaluation cut = EvaluateSurface(truth, Rectangle(0, 0, 10.2, 10, 0), {}, scope);
  EXPECT_DOUBLE_EQ(cut.completeness_percent, 100);
  EXPECT_DOUBLE_EQ(cut.boundary_iou, 1) << "the end of what was seen is no outline";
  const SurfaceEvaluation guessed = EvaluateSurface(truth, Rectangle(0, 0, 20, 10, 0), {}, scope);
  EXPECT_DOUBLE_EQ(guessed.false_free_percent, 0);
  EXPECT_DOUBLE_EQ(guessed.iou, 1);
  const SurfaceEvaluation missed = EvaluateSurface(truth, Rectangle(0, 0, 5, 10, 0), {}, scope);
  EXPECT_NEAR(missed.completeness_percent, 52, 0.5) << "what was seen is asked for";
  EXPECT_LT(missed.boundary_iou, 0.8);
}

TEST(EvaluateSurface, AnOutlineMadeOfSquaresStaysWhereItIs) {
  // The truth of simulated drives is made of squares of 0.1 m; its area must come out exactly.
  const SurfaceEvaluation evaluation =
      EvaluateSurface(Rectangle(0, 0, 20, 10, 0), Rectangle(0.1, 0, 20, 10, 0));

  EXPECT_NEAR(evaluation.truth_area, 200, 1e-9);
  EXPECT_NEAR(evaluation.estimate_area, 199, 1e-9);
}

TEST(EvaluateSurface, RampsAreJudgedOnTheirOwn) {
  TriangleMesh truth = Rectangle(0, 0, 20, 10, 0), estimate = Rectangle(0, 0, 20, 10, 0.01);
  AddRectangle(truth, 20, 0, 40, 10, 0);
  AddRectangle(estimate, 20, 0, 40, 10, 0);
  for (TriangleMesh* mesh : {&truth, &estimate})
    for (size_t i : {5, 6}) mesh->vertices[i].z() += mesh == &truth ? 3.0F : 3.06F;

  const SurfaceEvaluation evaluation = EvaluateSurface(truth, estimate);

  EXPECT_NEAR(evaluation.ramp_area, 190, 10);
  EXPECT_NEAR(evaluation.ramp_height_rmse, 0.06 / std::sqrt(3), 0.005);
}

TEST(EvaluateSurface, AnEmptyEstimateIsNamed) {
  EXPECT_THROW(EvaluateSurface(Rectangle(0, 0, 1, 1, 0), TriangleMesh{}), Error);
  EXPECT_THROW(EvaluateSurface(TriangleMesh{}, Rectangle(0, 0, 1, 1, 0)), Error);
}

TEST(EvaluateSurface, TextAndJsonHoldTheFigures) {
  const SurfaceEvaluation evaluation =
      EvaluateSurface(Rectangle(0, 0, 20, 10, 1), Rectangle(0, 0, 20, 10, 1.07));

  EXPECT_NE(ToText(evaluation).find("rmse 0.0700"), std::string::npos);
  EXPECT_NEAR(ToJson(evaluation)["height_rmse"].get<double>(), 0.07, 1e-4);
}

class ReadingPly : public testing::Test {
 protected:
  TriangleMesh Read(const std::string& content) {
    std::ofstream(file_, std::ios::binary) << content;
    return ReadPly(file_);
  }
  std::string MessageOf(const std::string& content) {
    try {
      Read(content);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
      return error.what();
    }
    return "";
  }
  void TearDown() override { std::filesystem::remove(file_); }

  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() /
      ("read_ply_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) +
       ".ply");
};

constexpr char kAsciiHeader[] =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty double x\nproperty "
    "double y\n"
    "property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty "
    "float height_sigma\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST_F(ReadingPly, AsciiWithColorsAndAPolygon) {
  const TriangleMesh mesh =
      Read(std::string(kAsciiHeader) +
           "500000.25 0 1 10 20 30 0.5\n500001.25 0 1 10 20 30 0.5\n"
           "500001.25 1 1 10 20 30 0.5\n500000.25 1 1 10 20 30 0.5\n4 0 1 2 3\n");

  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
  EXPECT_EQ(mesh.colors[2], (std::array<std::uint8_t, 3>{10, 20, 30}));
  EXPECT_FLOAT_EQ(mesh.height_sigmas[3], 0.5F);
  EXPECT_NEAR(mesh.vertices[0].x() + mesh.origin.x(), 500000.25, 1e-9)
      << "large coordinates keep their precision";
  EXPECT_EQ(mesh.normals[0], Eigen::Vector3f::UnitZ()) << "worked out";
}

TEST_F(ReadingPly, BinaryWithWhatWeDoNotKnow) {
  std::string content =
      "ply\nformat binary_little_endian 1.0\ncomment origin 100 200 300\nelement camera "
      "1\nproperty short unknown\n"
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty int label\n"
      "element face 1\nproperty list uchar uint vertex_index\nend_header\n";
  const auto add = [&](auto value) {
    content.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  add(std::int16_t{7});
  for (const auto& [x, y] : {std::pair(0.F, 0.F), std::pair(1.F, 0.F), std::pair(0.F, 1.F)}) {
    for (const float value : {x, y, 2.F}) add(value);
    add(std::int32_t{-1});
  }
  add(std::uint8_t{3});
  for (const std::uint32_t index : {0U, 1U, 2U}) add(index);

  const TriangleMesh mesh = Read(content);

  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.vertices[1].cast<double>() + mesh.origin, Eigen::Vector3d(101, 200, 302));
}

TEST_F(ReadingPly, DamageIsNamed) {
  const std::string header = kAsciiHeader;
  EXPECT_NE(MessageOf("").find("header"), std::string::npos);
  EXPECT_NE(MessageOf("solid cube\n").find("not a PLY"), std::string::npos);
  EXPECT_NE(MessageOf("ply\nformat binary_big_endian 1.0\nend_header\n").find("binary_big_endian"),
            std::string::npos);
  EXPECT_NE(MessageOf(header + "0 0 0 1 1 1 0\n").find("ends before"), std::string::npos);
  const std::string vertices = "0 0 0 1 1 1 0\n1 0 0 1 1 1 0\n1 1 0 1 1 1 0\n0 1 0 1 1 1 0\n";
  EXPECT_NE(MessageOf(header + vertices + "3 0 1 9\n").find("beyond"), std::string::npos);
  EXPECT_NE(MessageOf(header + vertices + "3 0 1 -2\n").find("beyond"), std::string::npos);
  EXPECT_NE(MessageOf(header + "0 0 x 1 1 1 0\n").find("'x'"), std::string::npos);
  EXPECT_NE(
      MessageOf(header + "nan 0 0 1 1 1 0\n1 0 0 1 1 1 0\n1 1 0 1 1 1 0\n0 1 0 1 1 1 0\n3 0 1 2\n")
          .find("finite"),
      std::string::npos);
}

TEST_F(ReadingPly, ACountThatTheFileCannotHoldTakesNoMemory) {
  EXPECT_NE(
      MessageOf(
          "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n1 2 3\n")
          .find("ends before"),
      std::string::npos);
}

TEST_F(ReadingPly, AFileThatIsNotThereIsNotFound) {
  try {
    ReadPly("no_such_file.ply");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kNotFound);
  }
}

}  // namespace
}  // namespace parkade
