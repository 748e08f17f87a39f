#include "mapping/ground/latest_drives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

/// Ten views of a drive along y = 0 from x = 0 to 9, each 20 m wide.
void AddDrive(int drive, double height, std::vector<PatchView>& views) {
  for (int i = 0; i < 10; ++i) {
    PatchView& view = views.emplace_back();
    view.drive = drive;
    view.site_from_body.translation = Eigen::Vector3d(i, 0, height);
    view.extent = {Eigen::Vector2d(i - 10, -10), Eigen::Vector2d(i + 10, 10)};
  }
}

TEST(LatestDrives, OfManyTheLatestCount) {
  std::vector<PatchView> views;
  for (int drive = 0; drive < 5; ++drive) AddDrive(drive, 0, views);
  views[5].extent = {Eigen::Vector2d(1, -3), Eigen::Vector2d(7, 3)};
  const LatestDrives latest(views, 3);

  for (size_t i = 0; i < views.size(); ++i)
    EXPECT_EQ(latest.ShareOf(i).Counts({5, 1}), views[i].drive >= 2) << views[i].drive;
  EXPECT_TRUE(latest.ShareOf(5).is_none()) << "it need not be read";
}

TEST(LatestDrives, OfManyTheLatestSayWhereTheirCarsDrove) {
  std::vector<PatchView> views;
  for (int drive = 0; drive < 5; ++drive) AddDrive(drive, 0, views);
  AddDrive(7, 3, views);
  const LatestDrives latest(views, 3);
  for (int drive = 0; drive < 5; ++drive)
    EXPECT_EQ(latest.CountsAsDriven(drive, {5, 1, 0.2}), drive >= 2) << drive;
  EXPECT_TRUE(latest.CountsAsDriven(0, {500, 1, 0})) << "nobody else looked there";
  EXPECT_TRUE(latest.CountsAsDriven(7, {5, 1, 3})) << "on its deck";
  EXPECT_TRUE(latest.CountsAsDriven(6, {5, 1, 0})) << "it has no views";
}

/// As AddDrive, 40 views of a drive in an aisle along `y`, whose views reach 20 m to each side.
void AddAisle(int drive, double y, std::vector<PatchView>& views) {
  for (int i = 0; i < 40; ++i) {
    PatchView& view = views.emplace_back();
    view.drive = drive;
    view.site_from_body.translation = Eigen::Vector3d(0.25 * i, y, 0);
    view.extent = {Eigen::Vector2d(-10, y - 20), Eigen::Vector2d(20, y + 20)};
  }
}

TEST(LatestDrives, InItsOwnAisleADriveCountsThoughOthersLookOverFromTheNext) {
  std::vector<PatchView> views;
  for (int drive = 0; drive < 3; ++drive) AddAisle(drive, 0, views);
  for (int drive = 3; drive < 8; ++drive) AddAisle(drive, 16, views);
  const LatestDrives latest(views, 2);
  const auto counts = [&](int drive, const Eigen::Vector2d& place) {
    for (size_t i = 0; i < views.size(); ++i)
      if (views[i].drive == drive && latest.ShareOf(i).Counts(place)) return true;
    return false;
  };
  for (int drive = 0; drive < 8; ++drive) {
    EXPECT_EQ(counts(drive, {5, 2}), drive == 1 || drive == 2 || drive >= 6) << drive;
    EXPECT_EQ(counts(drive, {5, 18}), drive >= 6) << drive;
    EXPECT_EQ(latest.CountsAsDriven(drive, {5, 1, 0}), drive != 0 && (drive < 3 || drive > 5))
        << drive;
  }
}

TEST(LatestDrives, WhereALaneWasDrivenLastOthersThatLookedNowDoNotSayOtherwise) {
  std::vector<PatchView> views;
  AddAisle(0, 2, views);
  for (int drive = 1; drive < 5; ++drive) AddAisle(drive, 6, views);
  const LatestDrives latest(views, 2);
  EXPECT_FALSE(latest.ShareOf(0).Counts({5, 2})) << "others saw it better";
  EXPECT_TRUE(latest.CountsAsDriven(0, {5, 2, 0})) << "no later car drove there";
  EXPECT_FALSE(latest.CountsAsDriven(1, {5, 6, 0}));
}

TEST(LatestDrives, WherePlacesAreSeldomLookedAtMoreDrivesCount) {
  std::vector<PatchView> views;
  for (int drive = 0; drive < 6; ++drive) AddDrive(drive, 0, views);
  const LatestDrives latest(views, 2);

  // Ten views of a drive see (6, 2), three see (-6, 2).
  for (int drive = 0; drive < 6; ++drive) {
    const LatestDrives::Share share = latest.ShareOf(static_cast<size_t>(10 * drive));
    EXPECT_EQ(share.Counts({6, 2}), drive >= 3) << drive;
    EXPECT_TRUE(share.Counts({-6, 2})) << drive;
  }
}

TEST(LatestDrives, OfManyViewsTheNearestCount) {
  std::vector<PatchView> views;  // of 2 drives, 100 each, along y = 0 from x = 0 to 10
  for (int i = 0; i < 200; ++i) {
    PatchView& view = views.emplace_back();
    view.drive = i / 100;
    view.site_from_body.translation = Eigen::Vector3d(0.1 * (i % 100), 0, 0);
    view.extent = {Eigen::Vector2d(0, 0), Eigen::Vector2d(4, 4)};
  }
  const LatestDrives latest(views, 3);
  const auto count = [&](size_t first) {
    int count = 0;
    for (size_t i = first; i < first + 100; ++i) count += !latest.ShareOf(i).is_none();
    return count;
  };
  EXPECT_EQ(count(0), 12) << "of an earlier drive";
  EXPECT_EQ(count(100), 64) << "of the latest";
  EXPECT_FALSE(latest.ShareOf(20).is_none()) << "right beside the middle";
  EXPECT_FALSE(latest.ShareOf(120).is_none());
  EXPECT_TRUE(latest.ShareOf(199).is_none());
}

/// 100 views of a drive along y = 2 from x = 0 to 40, each 16 m long.
void AddLongDrive(int drive, std::vector<PatchView>& views) {
  for (int i = 0; i < 100; ++i) {
    PatchView& view = views.emplace_back();
    view.drive = drive;
    view.site_from_body.translation = Eigen::Vector3d(0.4 * i, 2, 0);
    view.extent = {Eigen::Vector2d(0.4 * i - 7.9, 0.1), Eigen::Vector2d(0.4 * i + 7.9, 3.9)};
  }
}

/// Whether a view counts in the square from `x` to `x` + 4 m that it reaches into.
bool CountsIn(int x, const PatchView& view, const LatestDrives::Share& share) {
  return x + 4 > view.extent.min().x() && x <= view.extent.max().x() && share.Counts({x + 2, 2});
}

TEST(LatestDrives, ChosenViewsOfAnEarlierDriveCountWhereTheyAreNearest) {
  std::vector<PatchView> views;
  for (int drive = 0; drive < 2; ++drive) AddLongDrive(drive, views);
  const LatestDrives latest(views, 3);
  for (int x = 8; x < 32; x += 4) {
    int num_counting = 0, num_of_latest = 0;
    double farthest_counting = 0, nearest_left_out = 100;
    for (size_t i = 0; i < 100; ++i) {
      num_of_latest += CountsIn(x, views[100 + i], latest.ShareOf(100 + i));
      const double distance = std::abs(views[i].site_from_body.translation.x() - (x + 2));
      if (distance > 7.9) continue;  // it does not look at the square's middle
      if (CountsIn(x, views[i], latest.ShareOf(i))) {
        ++num_counting;
        farthest_counting = std::max(farthest_counting, distance);
      } else if (!latest.ShareOf(i).is_none()) {
        nearest_left_out = std::min(nearest_left_out, distance);
      }
    }
    EXPECT_EQ(num_counting, 12) << x;
    EXPECT_LE(farthest_counting, nearest_left_out) << x;
    EXPECT_GT(num_of_latest, 2 * num_counting) << x;
  }
}

TEST(LatestDrives, TheExtentOfAShareIsThatOfItsSquares) {
  std::vector<PatchView> views;
  for (int drive = 0; drive < 2; ++drive) AddLongDrive(drive, views);
  const LatestDrives latest(views, 3);
  int num_smaller = 0;
  for (size_t i = 0; i < views.size(); ++i) {
    const LatestDrives::Share& share = latest.ShareOf(i);
    Eigen::AlignedBox2d counting;
    for (int x = -12; x < 52; x += 4)
      if (CountsIn(x, views[i], share))
        counting.extend(Eigen::Vector2d(x, 0)).extend(Eigen::Vector2d(x + 4, 4));
    ASSERT_EQ(share.Extent().isEmpty(), counting.isEmpty()) << i;
    if (counting.isEmpty()) continue;
    EXPECT_EQ(share.Extent().min().x(), counting.min().x()) << i;
    EXPECT_EQ(share.Extent().max().x(), counting.max().x()) << i;
    num_smaller += !share.Extent().contains(views[i].extent);
  }
  EXPECT_GT(num_smaller, 0) << "of the earlier drive";
}

TEST(LatestDrives, AGlimpseDoesNotMakeADriveTheLatest) {
  std::vector<PatchView> views(101);
  for (PatchView& view : views) view.extent = {Eigen::Vector2d(0, 0), Eigen::Vector2d(4, 4)};
  views.back().drive = 1;
  const LatestDrives latest(views, 3);
  int count = 0;
  for (size_t i = 0; i < 100; ++i) count += !latest.ShareOf(i).is_none();
  EXPECT_EQ(count, 64);
  EXPECT_FALSE(latest.ShareOf(100).is_none());
}

TEST(LatestDrives, NarrowViewsAllCount) {
  std::vector<PatchView> views(100);
  for (PatchView& view : views) view.extent = {Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1)};
  const LatestDrives latest(views, 3);
  for (size_t i = 0; i < views.size(); ++i) EXPECT_TRUE(latest.ShareOf(i).Counts({0.5, 0.5}));
}

TEST(LatestDrives, DecksAreToldApart) {
  std::vector<PatchView> views;
  AddDrive(0, 3, views);
  for (int drive = 1; drive < 5; ++drive) AddDrive(drive, 0, views);

  EXPECT_TRUE(LatestDrives(views, 2).ShareOf(0).Counts({5, 1}));
}

TEST(LatestDrives, FewDrivesAllCount) {
  std::vector<PatchView> views;
  for (int drive = 0; drive < 3; ++drive) AddDrive(drive, 0, views);
  const LatestDrives latest(views, 3);
  for (size_t i = 0; i < views.size(); ++i) EXPECT_TRUE(latest.ShareOf(i).Counts({5, 1}));
}

}  // namespace
}  // namespace parkade
