#include "slam/sessions/link_all_drives.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/slam/worlds/drive_world.h"

namespace parkade {
namespace {

/// Remembers pairs of drives that have names, and counts what had to be computed.
class NamedMemory {
 public:
  PairMemory For(const std::vector<std::string>& names) {
    return [this, names](const std::string& what, size_t a, size_t b, const std::function<std::string()>& compute) {
      const std::string key = what + " " + names[a] + " " + names[b];
      if (!known_.contains(key)) {
        known_[key] = compute();
        ++num_computed_[what];
      }
      return known_[key];
    };
  }
  int TakeComputed(const std::string& what) { return std::exchange(num_computed_[what], 0); }

 private:
  std::map<std::string, std::string> known_;
  std::map<std::string, int> num_computed_;
};

std::vector<DriveToJoin> DrivesOf(const DriveWorld& world, std::uint32_t first_seed, std::uint32_t count) {
  std::vector<DriveToJoin> drives;
  for (std::uint32_t i = 0; i < count; ++i) drives.push_back(world.Drive(first_seed + i).drive);
  return drives;
}

TEST(LinkAllDrives, OfManyDrivesOnlyAlikeOnesAreLinkedAndAllHangTogether) {
  const std::vector<DriveToJoin> drives = DrivesOf(DriveWorld(), 1, 5);
  const std::vector<DrivePair> pairs = LinkAllDrives(drives, {}, {.all_pairs_up_to = 3, .partners = 1}, {});
  EXPECT_LE(pairs.size(), 7u) << "of 10: each drive's partner, and what joins groups";
  EXPECT_EQ(FindGroups(drives.size(), pairs), std::vector<size_t>(5, 0));
  EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end(), [](const DrivePair& x, const DrivePair& y) {
    return std::pair(x.drive_b, x.drive_a) < std::pair(y.drive_b, y.drive_a);
  }));
}

TEST(LinkAllDrives, OneMoreDriveCostsItsOwnPairsOnly) {
  std::vector<DriveToJoin> drives = DrivesOf(DriveWorld(), 1, 4);
  const DriveLinkOptions options = {.all_pairs_up_to = 2, .partners = 1};
  NamedMemory memory;
  LinkAllDrives(drives, {}, options, memory.For({"a", "b", "c", "d"}));
  EXPECT_EQ(memory.TakeComputed("likeness"), 6);
  memory.TakeComputed("links");

  drives.push_back(DriveWorld().Drive(5).drive);
  const std::vector<DrivePair> pairs = LinkAllDrives(drives, {}, options, memory.For({"a", "b", "c", "d", "e"}));
  EXPECT_EQ(memory.TakeComputed("likeness"), 4);
  EXPECT_LE(memory.TakeComputed("links"), 4);
  EXPECT_EQ(FindGroups(drives.size(), pairs), std::vector<size_t>(5, 0));

  // The same drives again, nothing to do; and what is remembered is what is computed.
  const std::vector<DrivePair> again = LinkAllDrives(drives, {}, options, memory.For({"a", "b", "c", "d", "e"}));
  EXPECT_EQ(memory.TakeComputed("likeness") + memory.TakeComputed("links"), 0);
  const std::vector<DrivePair> afresh = LinkAllDrives(drives, {}, options, {});
  ASSERT_EQ(again.size(), afresh.size());
  for (size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(again[i].drive_a, afresh[i].drive_a);
    ASSERT_EQ(again[i].found.links.size(), afresh[i].found.links.size());
    for (size_t k = 0; k < again[i].found.links.size(); ++k)
      EXPECT_EQ(again[i].found.links[k].pose.a_from_b.Matrix(), afresh[i].found.links[k].pose.a_from_b.Matrix());
  }
}

TEST(LinkAllDrives, ADriveOfAnotherPlaceStaysApart) {
  std::vector<DriveToJoin> drives = DrivesOf(DriveWorld(), 1, 3);
  drives.push_back(DriveWorld({.seed = 2}).Drive(4).drive);
  const std::vector<DrivePair> pairs = LinkAllDrives(drives, {}, {.all_pairs_up_to = 2, .partners = 1}, {});
  EXPECT_EQ(FindGroups(drives.size(), pairs), (std::vector<size_t>{0, 0, 0, 3}));
}

TEST(LikenessOf, TellsDrivesOfOnePlaceFromThoseOfAnother) {
  const DriveWorld world, elsewhere({.seed = 2});
  const std::vector<Place> places = world.Drive(1).drive.places, back = world.Drive(2, true).drive.places,
                           there = world.Drive(2).drive.places, apart = elsewhere.Drive(3).drive.places;
  const ComparedDrive drive(places);
  const double same = LikenessOf(drive, ComparedDrive(back), {});
  const double other = LikenessOf(drive, ComparedDrive(apart), {});
  EXPECT_GT(same, 3 * other);
  EXPECT_LE(same, 1);
  EXPECT_EQ(LikenessOf(drive, ComparedDrive(there), {}, Rigid3{Eigen::Quaterniond::Identity(), {500, 0, 0}}), 0);
}

}  // namespace
}  // namespace parkade
