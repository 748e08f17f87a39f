#include "server/pipeline/slot_looks.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files/file.h"
#include "export/markings.h"
#include "server/pipeline/plan_stages.h"
#include "tests/server/store/temporary_root.h"
#include "tests/server/worlds/straight_drive.h"

namespace parkade {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

const Rigid3 kTurned{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3d::UnitZ())),
                     Vector3d(30, 4, 2)};

ParkingSlot SlotAt(double x) {
  ParkingSlot slot;
  slot.id = "slot_" + std::to_string(x);
  slot.corners = {Vector3d(x, 3, 0), {x + 2.5, 3, 0}, {x + 2.5, 8, 0}, {x, 8, 0}};
  return slot;
}

/// A map of one or two drives with two slots, and another one that is built from it.
class SlotLooksTest : public testing::Test {
 protected:
  void WriteEarlierMap(const std::vector<std::string>& drives) {
    json report = {{"drives", json::array()}, {"datum", nullptr}};
    const Trajectory trajectory = StraightDrive(40);
    for (const std::string& drive : drives) {
      report["drives"].push_back({{"name", drive}});
      std::filesystem::create_directories(root_.path() / drive);
      std::vector<TimedPose> poses;
      for (const TrajectoryState& state : trajectory.states())
        poses.push_back({state.time, state.world_from_body});
      WriteTum(poses, root_.path() / drive / "trajectory.tum");
    }
    WriteFileAtomically(root_.path() / "report.json", report.dump());
    std::vector<ParkingSlot> slots = {SlotAt(4), SlotAt(36)};
    for (ParkingSlot& slot : slots) slot.states.assign(drives.size(), SlotState::kOccupied);
    WriteFileAtomically(SlotsFile(), EncodeSlotsGeoJson(slots, drives, {}, {}));
  }

  /// What is known of a map of "monday", which lies at `site_from_body` now.
  std::vector<SlotLook> Looks(const Trajectory& site_from_body) {
    BuildScope scope;
    scope.from = root_.path();
    const MapOptions options;
    SiteMap map;
    map.drives.push_back({"today", {}, {}, {}});
    map.drives.push_back({"monday", {}, {}, site_from_body});
    Progress progress(PlanStages(1, false), {});
    return LooksBefore(BuildContext(options, scope), {}, {}, map, progress);
  }

  std::filesystem::path SlotsFile() const { return root_.path() / "slots.geojson"; }

  TemporaryRoot root_;
};

TEST_F(SlotLooksTest, AnEarlierMapsSlotsMoveWithItsDrive) {
  WriteEarlierMap({"monday"});
  const std::vector<SlotLook> looks = Looks(StraightDrive(40).Transformed(kTurned));
  ASSERT_EQ(looks.size(), 2U);
  ASSERT_EQ(looks[0].slots.size(), 2U);
  EXPECT_TRUE(looks[0].establishes);
  EXPECT_EQ(looks[0].slots[1].id, SlotAt(36).id);
  EXPECT_LT((looks[0].slots[1].Center() - kTurned * SlotAt(36).Center()).norm(), 0.001);
}

TEST_F(SlotLooksTest, WhatADriveSawInThemIsKnownByItsName) {
  WriteEarlierMap({"monday"});
  const std::vector<SlotLook> looks = Looks(StraightDrive(40).Transformed(kTurned));
  EXPECT_EQ(looks[0].tells_of, (std::vector<bool>{false, true}));
  for (const ParkingSlot& slot : looks[0].slots)
    EXPECT_EQ(slot.states, (std::vector{SlotState::kUnseen, SlotState::kOccupied}));
}

TEST_F(SlotLooksTest, WithoutOneOfItsDrivesOnlyTheirNamesCount) {
  WriteEarlierMap({"monday", "tuesday"});
  for (const SlotLook& look : Looks(StraightDrive(40)))
    EXPECT_EQ(look.slots.size(), look.establishes ? 0U : 2U);
}

TEST_F(SlotLooksTest, WhereItsDriveHasBentOnlyTheirNamesCount) {
  WriteEarlierMap({"monday"});
  std::vector<TrajectoryState> states = StraightDrive(40).states();
  for (TrajectoryState& state : states)
    if (state.world_from_body.translation.x() > 25) state.world_from_body.translation.y() += 1;
  for (const SlotLook& look : Looks(Trajectory(std::move(states)))) {
    ASSERT_EQ(look.slots.size(), 1U);
    EXPECT_EQ(look.slots[0].id, SlotAt(look.establishes ? 4 : 36).id);
  }
}

TEST_F(SlotLooksTest, ADamagedMapTellsNothing) {
  WriteEarlierMap({"monday"});
  WriteFileAtomically(SlotsFile(), "[");
  EXPECT_TRUE(Looks(StraightDrive(40)).empty());
}

}  // namespace
}  // namespace parkade
