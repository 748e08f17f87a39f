#include "mapping/ground/latest_drives.h"

#include <gtest/gtest.h>

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
  const LatestDrives latest(views, 3);

  for (size_t i = 0; i < views.size(); ++i)
    EXPECT_EQ(latest.ShareOf(views[i]).Counts({5, 1}), views[i].drive >= 2) << views[i].drive;
  PatchView narrow = views[5];
  narrow.extent = {Eigen::Vector2d(1, -3), Eigen::Vector2d(7, 3)};
  EXPECT_TRUE(latest.ShareOf(narrow).is_none()) << "it need not be read";
}

TEST(LatestDrives, WherePlacesAreSeldomLookedAtMoreDrivesCount) {
  std::vector<PatchView> views;
  for (int drive = 0; drive < 6; ++drive) AddDrive(drive, 0, views);
  const LatestDrives latest(views, 2);

  // Ten views of a drive see (6, 2), three see (-6, 2).
  for (int drive = 0; drive < 6; ++drive) {
    const LatestDrives::Share share = latest.ShareOf(views[static_cast<size_t>(10 * drive)]);
    EXPECT_EQ(share.Counts({6, 2}), drive >= 3) << drive;
    EXPECT_TRUE(share.Counts({-6, 2})) << drive;
  }
}

TEST(LatestDrives, DecksAreToldApart) {
  std::vector<PatchView> views;
  AddDrive(0, 3, views);
  for (int drive = 1; drive < 5; ++drive) AddDrive(drive, 0, views);

  EXPECT_TRUE(LatestDrives(views, 2).ShareOf(views[0]).Counts({5, 1}));
}

TEST(LatestDrives, FewDrivesAllCount) {
  std::vector<PatchView> views;
  for (int drive = 0; drive < 3; ++drive) AddDrive(drive, 0, views);
  const LatestDrives latest(views, 3);
  for (const PatchView& view : views) EXPECT_TRUE(latest.ShareOf(view).Counts({5, 1}));
}

}  // namespace
}  // namespace parkade
