#include "mapping/markings/find_markings.h"

#include <gtest/gtest.h>

#include "mapping/evaluation/evaluate_slots.h"
#include "tests/mapping/worlds/flat_ground.h"
#include "tests/mapping/worlds/test_surfaces.h"

namespace parkade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A drive straight along y = 0, over a bump that is `height` high and three meters long about x
/// = 4.
DrivenPath PathOverBump(SurfaceMap& surface, double height) {
  for (SurfaceCell& cell : surface.cells) {
    const double u = ((cell.x + 0.5) * surface.cell_size - 4) / 1.5;
    if (std::abs(u) < 1) cell.height += static_cast<float>(height * std::pow(1 - u * u, 2));
  }
  std::vector<TrajectoryState> states;
  for (int i = 0; i <= 280; ++i) {
    TrajectoryState state;
    state.time = TimestampFromSeconds(0.02 * i);
    state.world_from_body.translation = {-14 + 0.1 * i, 0, 1.5};
    states.push_back(state);
  }
  DrivenPath path;
  path.site_from_body = Trajectory(std::move(states));
  return path;
}

TEST(FindMarkings, PutsSlotsAcrossTilesOnTheGround) {
  PaintedGround painted;
  std::vector<TrueSlot> truth;
  for (int i = 0; i <= 8; ++i) {
    const double x = -10 + 2.5 * i;
    if (i != 4) painted.Line({x, 2.94}, {x, 8.06}, 0.12, cv::Scalar::all(200), i == 2 ? 2 : 1);
    if (i < 8) truth.push_back({{Vector2d(x, 3), {x + 2.5, 3}, {x + 2.5, 8}, {x, 8}}, 1.5});
  }
  FlatGround ground(painted.tile());
  const DrivenPath path = PathOverBump(ground.surface, 0.001);
  const GroundMarkings markings = FindMarkings(
      {ground.mesh, ground.surface, ground.texture, PatchesInMemory({}), std::span(&path, 1), 1});

  const SlotEvaluation evaluation = EvaluateSlots(truth, markings.slots);
  EXPECT_EQ(evaluation.num_missed, 0U);
  EXPECT_EQ(evaluation.num_right, markings.slots.size());
  EXPECT_LT(evaluation.corner_rmse, 0.03);
  for (const ParkingSlot& slot : markings.slots) {
    EXPECT_NEAR(slot.Center().z(), 1.5, 0.01);
    EXPECT_NEAR(slot.corners[0].y(), 3, 0.1) << "the entrance is where the car drove";
    EXPECT_EQ(slot.states, std::vector{SlotState::kUnseen});
  }
  int num_of_slots = 0;
  for (const RoadMarking& marking : markings.markings) num_of_slots += marking.is_of_slot;
  EXPECT_GE(num_of_slots, 8);
  EXPECT_TRUE(markings.bumps.empty());
}

TEST(FindMarkings, FindsNothingOnBareGround) {
  FlatGround ground(PaintedGround().tile());
  const GroundMarkings markings =
      FindMarkings({ground.mesh, ground.surface, ground.texture, PatchesInMemory({}), {}, 0});
  EXPECT_TRUE(markings.slots.empty());
  EXPECT_TRUE(markings.markings.empty());
  EXPECT_TRUE(
      FindMarkings({ground.mesh, ground.surface, {}, PatchesInMemory({}), {}, 0}).slots.empty());
}

TEST(FindSpeedBumps, MeasuresWhatACarDroveOver) {
  FlatGround ground(PaintedGround(30, 0.1).tile());
  const DrivenPath path = PathOverBump(ground.surface, 0.07);
  const std::vector<DrivenPath> twice = {path, path};
  const std::vector<SpeedBump> bumps = FindSpeedBumps(ground.surface, twice);
  ASSERT_EQ(bumps.size(), 1U);
  EXPECT_EQ(bumps[0].num_passes, 2);
  EXPECT_NEAR(bumps[0].height, 0.07, 0.01);
  EXPECT_NEAR(bumps[0].crest.x(), 4, 0.2);
  EXPECT_NEAR(bumps[0].length, 2.4, 0.6);
  EXPECT_NEAR(bumps[0].yaw, 0, 0.01);
}

TEST(FindSpeedBumps, MeasuresThemOnTopOfARise) {
  FlatGround ground(PaintedGround(30, 0.1).tile());
  const DrivenPath path = PathOverBump(ground.surface, 0.05);
  for (SurfaceCell& cell : ground.surface.cells) {
    const double from_crest = (cell.x + 0.5) * ground.surface.cell_size - 4;
    cell.height -= static_cast<float>(0.5 * 0.004 * from_crest * from_crest);
  }
  const std::vector<SpeedBump> bumps = FindSpeedBumps(ground.surface, std::span(&path, 1));
  ASSERT_EQ(bumps.size(), 1U);
  EXPECT_NEAR(bumps[0].crest.x(), 4, 0.3);
  EXPECT_NEAR(bumps[0].height, 0.07, 0.01) << "with the rise below it";
}

TEST(FindSpeedBumps, RampsAndRoughnessAreNone) {
  FlatGround ground(PaintedGround(30, 0.1).tile());
  const DrivenPath path = PathOverBump(ground.surface, 0.015);
  for (SurfaceCell& cell : ground.surface.cells)
    cell.height += static_cast<float>(0.12 * std::max(0, cell.x) * 0.25);
  EXPECT_TRUE(FindSpeedBumps(ground.surface, std::span(&path, 1)).empty());
}

}  // namespace
}  // namespace parkade
