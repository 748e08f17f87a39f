#include "server/pipeline/name_slots.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/server/worlds/straight_drive.h"

namespace parkade {
namespace {

using Eigen::Vector3d;

/// A row of fourteen slots beside a drive.
std::vector<ParkingSlot> Row(const Rigid3& site_from_odom) {
  std::vector<ParkingSlot> slots;
  for (int i = 0; i < 14; ++i) {
    const double x = 0.6 + 2.5 * i;
    ParkingSlot slot;
    slot.corners = {Vector3d(x, 3, 0), {x + 2.5, 3, 0}, {x + 2.5, 8, 0}, {x, 8, 0}};
    slots.push_back(Moved(slot, site_from_odom));
  }
  return slots;
}

std::vector<ParkingSlot> Named(std::vector<ParkingSlot> slots, const std::string& drive,
                               const Rigid3& site_from_odom) {
  const Trajectory odometry = StraightDrive(40);
  NameSlots({{drive, {odometry.Transformed(site_from_odom), odometry}}}, slots);
  return slots;
}

TEST(NameSlots, AreTheSameHoweverTheSiteLies) {
  const Rigid3 moved{Eigen::Quaterniond(Eigen::AngleAxisd(1, Vector3d::UnitZ())),
                     Vector3d(100, 50, 3)};
  const std::vector<ParkingSlot> first = Named(Row({}), "monday", {}),
                                 again = Named(Row(moved), "monday", moved),
                                 other = Named(Row({}), "tuesday", {});
  std::set<std::string> ids;
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].id, again[i].id);
    EXPECT_EQ(first[i].id.size(), 15U) << first[i].id;
    ids.insert(first[i].id), ids.insert(other[i].id);
  }
  EXPECT_EQ(ids.size(), 2 * first.size()) << "slots that another drive found are others";
}

TEST(NameSlots, NoneIsGivenTwice) {
  std::vector<ParkingSlot> slots = Row({}), same = Row({});
  slots.insert(slots.end(), same.begin(), same.end());
  slots[0].id = slots[1].id = "kept";
  slots = Named(slots, "monday", {});
  std::set<std::string> ids;
  for (const ParkingSlot& slot : slots) ids.insert(slot.id);
  EXPECT_EQ(ids.size(), slots.size());
  EXPECT_EQ(slots[0].id, "kept");
}

}  // namespace
}  // namespace parkade
