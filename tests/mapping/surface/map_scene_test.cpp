// The whole of mapping/ on drives through scenes whose every point is known: true poses in, surface
// out.

#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "core/parallel.h"
#include "mapping/evaluation/evaluate_surface.h"
#include "mapping/mesh/mesh_surface.h"
#include "mapping/observation/observe_ground.h"
#include "tests/mapping/worlds/fuse_patches.h"
#include "tests/mapping/worlds/synthetic_drive.h"

namespace parkade {
namespace {

struct MappedScene {
  GroundObservation observation;
  SurfaceMap surface;
  TriangleMesh mesh;
};

std::vector<PosedGroundPatch> Pose(const std::vector<GroundPatch>& patches,
                                   const Trajectory& site_from_body) {
  std::vector<PosedGroundPatch> posed;
  for (const GroundPatch& patch : patches)
    posed.push_back({patch, site_from_body.At(patch.time).value()});
  return posed;
}

/// The surface from above, 5 cm per pixel, for people: written where PARKADE_TEST_PICTURES says.
void SaveImage(const SurfaceMap& surface, const std::string& name, double min_height = -1e9) {
  const char* folder = std::getenv("PARKADE_TEST_PICTURES");
  if (folder == nullptr || surface.cells.empty()) return;
  int low_x = INT_MAX, low_y = INT_MAX, high_x = INT_MIN, high_y = INT_MIN;
  for (const SurfaceCell& cell : surface.cells) {
    low_x = std::min(low_x, cell.x), high_x = std::max(high_x, cell.x);
    low_y = std::min(low_y, cell.y), high_y = std::max(high_y, cell.y);
  }
  cv::Mat image(high_y - low_y + 1, high_x - low_x + 1, CV_8UC3, cv::Scalar(80, 0, 80));
  for (const SurfaceCell& cell : surface.cells) {
    if (static_cast<double>(cell.height) < min_height) continue;
    cv::Vec3b color(cell.color[2], cell.color[1], cell.color[0]);
    if (cell.free_belief < 0.55F)
      color = {static_cast<uchar>(color[0] / 3), static_cast<uchar>(color[1] / 3), 200};
    image.at<cv::Vec3b>(high_y - cell.y, cell.x - low_x) = color;
  }
  cv::imwrite(std::string(folder) + "/" + name + ".png", image);
}

MappedScene MapScene(const SyntheticDrive& drive, const std::string& image,
                     const GroundOptions& options = {}) {
  MappedScene mapped;
  mapped.observation = ObserveGround(drive, drive.trajectory(), {}, 0, options);
  const DrivenPath path =
      MakeDrivenPath(0, drive.rig(), drive.trajectory(), mapped.observation.body_from_ground);
  mapped.surface =
      FuseSurface(Pose(mapped.observation.patches, drive.trajectory()), std::span(&path, 1));
  mapped.mesh = MeshSurface(mapped.surface);
  SaveImage(mapped.surface, image);
  return mapped;
}

std::vector<Eigen::Vector3d> PathOf(const Trajectory& trajectory) {
  std::vector<Eigen::Vector3d> path;
  for (const TrajectoryState& state : trajectory.states())
    path.push_back(state.world_from_body.translation);
  return path;
}

SurfaceEvaluation Evaluate(const SyntheticDrive& drive, const TriangleMesh& mesh,
                           double max_path_distance) {
  SurfaceEvaluationOptions options;
  options.max_path_distance = max_path_distance;
  const std::vector<Eigen::Vector3d> path = PathOf(drive.trajectory());
  const SurfaceEvaluation evaluation =
      EvaluateSurface(drive.scene().DrivableMesh(), mesh, options, {.path = path, .find_seen = {}});
  if (std::getenv("PARKADE_TEST_PICTURES") != nullptr)
    std::printf("%s", ToText(evaluation).c_str());
  return evaluation;
}

SyntheticDrive LotDrive(bool has_masks) {
  const Rig rig = MakeTestRig();
  const SyntheticScene scene = MakeLot();
  return SyntheticDrive(scene, rig, DriveAlong(scene, {-18, 0, 0}, 0, {{30, 0}}, rig), has_masks);
}

TEST(MapScene, AFlatLotWithMasksComesOutFlatCompleteAndClean) {
  const SyntheticDrive drive = LotDrive(true);

  const MappedScene mapped = MapScene(drive, "lot_masks");

  EXPECT_EQ(mapped.observation.num_masks, mapped.observation.num_images);
  EXPECT_TRUE(mapped.observation.warnings.empty());
  const SurfaceEvaluation evaluation = Evaluate(drive, mapped.mesh, 6.0);
  EXPECT_LT(evaluation.height_rmse, 0.02);
  EXPECT_LT(evaluation.height_p95, 0.02);
  EXPECT_LT(evaluation.height_max, 0.05);
  EXPECT_GT(evaluation.completeness_percent, 90);
  EXPECT_LT(evaluation.false_free_percent, 2);
  EXPECT_GT(evaluation.iou, 0.85);
}

TEST(MapScene, ColorsAreThoseOfThePlace) {
  const SyntheticDrive drive = LotDrive(true);

  const MappedScene mapped = MapScene(drive, "lot_masks");

  // Cells well inside a line or well off it, on both sides of the lane.
  double error = 0;
  int count = 0, num_white = 0;
  for (const SurfaceCell& cell : mapped.surface.cells) {
    const Eigen::Vector3d center((cell.x + 0.5) * 0.05, (cell.y + 0.5) * 0.05, 0);
    if (std::abs(center.x()) > 8 || std::abs(center.y()) > 4 || cell.free_belief < 0.55F) continue;
    const Bgr truth = SyntheticScene::ColorAt(drive.scene().quads().front(), center);
    if (truth[0] == 225 && std::abs(center.y()) < 4 && cell.color[1] > 170) ++num_white;
    error += std::abs(int{cell.color[1]} - int{truth[1]});
    ++count;
  }
  EXPECT_GT(count, 10000);
  EXPECT_LT(error / count, 8);
  EXPECT_GT(num_white, 200) << "the lines of the slots have to show";
}

TEST(MapScene, AParkedCarIsNotFreeSpace) {
  const SyntheticDrive drive = LotDrive(true);

  const MappedScene mapped = MapScene(drive, "lot_masks");

  int num_free = 0;
  for (const SurfaceCell& cell : mapped.surface.cells) {
    const double x = (cell.x + 0.5) * 0.05, y = (cell.y + 0.5) * 0.05;
    if (std::abs(x - 1.25) < 0.7 && y > 3.7 && y < 7.5 && cell.free_belief > 0.5F) ++num_free;
  }
  EXPECT_LT(num_free, 30) << "of 2128 cells under the car";
}

TEST(MapScene, WithoutMasksAndNetworkTheGuessByColorsKeepsToTheLot) {
  const SyntheticDrive drive = LotDrive(false);
  GroundOptions options;
  options.method = "colors";

  const MappedScene mapped = MapScene(drive, "lot_guess", options);

  EXPECT_EQ(mapped.observation.num_masks, 0);
  const SurfaceEvaluation evaluation = Evaluate(drive, mapped.mesh, 6.0);
  EXPECT_LT(evaluation.height_rmse, 0.02);
  EXPECT_GT(evaluation.completeness_percent, 75);
  EXPECT_LT(evaluation.false_free_percent, 5);
}

TEST(MapHardScene, TwoDecksStayTwoAndTheRampJoinsThem) {
  const Rig rig = MakeTestRig();
  const SyntheticScene scene = MakeDecks();
  const double half_turn = 3.14159265358979 * 5;
  const Trajectory trajectory =
      DriveAlong(scene, {-10, 0, 0}, 0, {{47.5, 0}, {half_turn, 0.2}, {44, 0}}, rig);
  const SyntheticDrive drive(scene, rig, trajectory, true);

  const MappedScene mapped = MapScene(drive, "decks");

  const SurfaceEvaluation evaluation = Evaluate(drive, mapped.mesh, 4.0);
  EXPECT_LT(evaluation.height_rmse, 0.03);
  EXPECT_GT(evaluation.completeness_percent, 90);
  EXPECT_LT(evaluation.false_free_percent, 3);
  int num_double = 0;
  for (size_t i = 1; i < mapped.surface.cells.size(); ++i) {
    const SurfaceCell &below = mapped.surface.cells[i - 1], &above = mapped.surface.cells[i];
    if (below.x != above.x || below.y != above.y) continue;
    EXPECT_GT(above.height - below.height, 1.5F);
    ++num_double;
  }
  EXPECT_GT(num_double, 2000) << "cells of the lower deck seen below the upper one";
}

TEST(MapHardScene, ARampAheadDoesNotBendTheLevelBeforeIt) {
  const Rig rig = MakeTestRig();
  const SyntheticScene scene = MakeDecks();
  const SyntheticDrive drive(scene, rig, DriveAlong(scene, {-6, 0, 0}, 0, {{30, 0}}, rig), true);

  const MappedScene mapped = MapScene(drive, "ramp");

  double sum = 0;
  int count = 0;
  for (const SurfaceCell& cell : mapped.surface.cells) {
    const double x = (cell.x + 0.5) * 0.05, y = (cell.y + 0.5) * 0.05;
    if (x < -4 || x > 22 || std::abs(y) > 1.5) continue;
    const double error = static_cast<double>(cell.height) - scene.GroundHeight(x, y, 1).value();
    sum += error * error;
    ++count;
  }
  EXPECT_GT(count, 10000);
  EXPECT_LT(std::sqrt(sum / count), 0.02);
}

TEST(MapHardScene, ACarThatStandsStillMapsItsSurroundingsOnce) {
  const Rig rig = MakeTestRig();
  const SyntheticScene scene = MakeLot();
  std::vector<PathPiece> standing(200);
  const SyntheticDrive drive(scene, rig, DriveAlong(scene, {0, 0, 0}, 0, standing, rig), true);

  const MappedScene mapped = MapScene(drive, "standing");

  EXPECT_EQ(mapped.observation.num_images, 4);
  EXPECT_NO_THROW(ValidateMesh(mapped.mesh));
}

TEST(MapHardScene, WithoutVehicleAndLandmarksThereIsNoMapButAReason) {
  const Rig rig = MakeTestRig(/*has_vehicle=*/false);
  const SyntheticScene scene = MakeLot();
  const SyntheticDrive drive(scene, rig, DriveAlong(scene, {-6, 0, 0}, 0, {{8, 0}}, rig), true);

  const MappedScene mapped = MapScene(drive, "none");

  EXPECT_TRUE(mapped.observation.patches.empty());
  ASSERT_EQ(mapped.observation.warnings.size(), 1u);
  EXPECT_NE(mapped.observation.warnings.front().find("no ground plane"), std::string::npos);
  EXPECT_TRUE(mapped.mesh.empty());
}

TEST(MapHardScene, WithoutVehicleThePlaneOfTheLandmarksIsUsed) {
  const Rig rig = MakeTestRig(/*has_vehicle=*/false);
  const SyntheticScene scene = MakeLot();
  const SyntheticDrive drive(scene, rig, DriveAlong(scene, {-14, 0, 0}, 0, {{24, 0}}, rig), true);
  std::vector<Landmark> landmarks;
  for (int i = 0; i < 600; ++i) {  // two thirds on the road, the rest on cars and walls
    const double x = -16 + 0.05 * i, y = 4 * std::sin(1.7 * i);
    const double z =
        i % 3 == 0 ? 0.4 + 0.9 * std::abs(std::sin(0.9 * i)) : 0.02 * std::sin(5.3 * i);
    landmarks.push_back({{}, 0, {x, y, z}, 0.02, 5});
  }

  const GroundObservation observation = ObserveGround(drive, drive.trajectory(), landmarks, 0);
  const DrivenPath path = MakeDrivenPath(0, rig, drive.trajectory(), observation.body_from_ground);
  const SurfaceMap surface =
      FuseSurface(Pose(observation.patches, drive.trajectory()), std::span(&path, 1));

  EXPECT_NEAR(observation.body_from_ground.translation.z(), -0.6, 0.01);
  const SurfaceEvaluation evaluation = Evaluate(drive, MeshSurface(surface), 4.0);
  EXPECT_LT(evaluation.height_rmse, 0.03);
  EXPECT_GT(evaluation.completeness_percent, 85);
}

TEST(MapScene, TheResultDoesNotDependOnTheNumberOfThreads) {
  const Rig rig = MakeTestRig();
  const SyntheticScene scene = MakeLot();
  const SyntheticDrive drive(scene, rig, DriveAlong(scene, {-6, 0, 0}, 0, {{6, 0}}, rig), false);

  SetNumThreads(1);
  const TriangleMesh alone = MapScene(drive, "threads").mesh;
  SetNumThreads(3);
  const TriangleMesh together = MapScene(drive, "threads").mesh;

  EXPECT_EQ(alone.triangles, together.triangles);
  EXPECT_EQ(alone.vertices, together.vertices);
  EXPECT_EQ(alone.colors, together.colors);
}

}  // namespace
}  // namespace parkade
