#include "mapping/evaluation/compare_surfaces.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/mapping/worlds/test_surfaces.h"

namespace parkade {
namespace {

constexpr double kCell = 0.1;

SurfaceMap FlatLot() {
  return MakeSurface(200, 150, kCell, [](double, double) { return 0.0; });
}

/// Sets what is inside [x0, x1) x [y0, y1) [m].
template <typename Change>
void ChangeInside(SurfaceMap& surface, double x0, double x1, double y0, double y1,
                  const Change& change) {
  for (SurfaceCell& cell : surface.cells) {
    const double x = (cell.x + 0.5) * kCell, y = (cell.y + 0.5) * kCell;
    if (x >= x0 && x < x1 && y >= y0 && y < y1) change(cell);
  }
}

void ParkCar(SurfaceMap& surface, double x, double y) {
  ChangeInside(surface, x, x + 1.8, y, y + 4.4,
               [](SurfaceCell& cell) { cell.free_belief = 0.05F; });
}

TEST(CompareSurfaces, FindsNothingBetweenAMapAndItself) {
  const SurfaceChanges changes = CompareSurfaces(FlatLot(), FlatLot(), {});
  EXPECT_TRUE(changes.regions.empty());
  EXPECT_NEAR(changes.UnchangedArea(), 300, 1e-6);
  EXPECT_EQ(changes.height.rmse, 0);
}

TEST(CompareSurfaces, FindsCarsThatCameAndWent) {
  SurfaceMap before = FlatLot(), after = FlatLot();
  ParkCar(before, 3, 2);
  ParkCar(after, 12, 5);
  ParkCar(before, 16, 9);
  ParkCar(after, 16, 9);
  const SurfaceChanges changes = CompareSurfaces(before, after, {});
  ASSERT_EQ(changes.regions.size(), 2U);
  EXPECT_EQ(changes.regions[0].change, GroundChange::kFreed);
  EXPECT_NEAR(changes.regions[0].area, 1.8 * 4.4, 0.1);
  EXPECT_NEAR((changes.regions[0].center.head<2>() - Eigen::Vector2d(3.9, 4.2)).norm(), 0, 0.05);
  EXPECT_EQ(changes.regions[1].change, GroundChange::kBlocked);
  EXPECT_NEAR(changes.AreaOf(GroundChange::kBlocked), 1.8 * 4.4, 0.1);
}

TEST(CompareSurfaces, KnowsACarByItsFoot) {
  SurfaceMap after = FlatLot();
  ParkCar(after, 3, 2);
  ChangeInside(after, 3.2, 4.6, 2.2, 6.4,
               [](SurfaceCell& cell) { cell.free_belief = 0.45F; });  // hidden by its sides
  ChangeInside(after, 12, 15, 5, 8,
               [](SurfaceCell& cell) { cell.free_belief = 0.45F; });  // hidden by others
  const SurfaceChanges changes = CompareSurfaces(FlatLot(), after, {});
  ASSERT_EQ(changes.regions.size(), 2U);
  EXPECT_EQ(changes.regions[0].change, GroundChange::kBlocked);
  EXPECT_NEAR(changes.regions[0].area, 1.8 * 4.4, 0.1);
  EXPECT_EQ(changes.regions[1].change, GroundChange::kUnmapped);
}

TEST(CompareSurfaces, LeavesOutBordersThatMovedAndWhatIsUnsure) {
  SurfaceMap after = FlatLot();
  ChangeInside(after, 0, 20, 0, 0.3, [](SurfaceCell& cell) { cell.free_belief = 0.05F; });
  ChangeInside(after, 5, 8, 5, 8, [](SurfaceCell& cell) { cell.free_belief = 0.55F; });
  EXPECT_TRUE(CompareSurfaces(FlatLot(), after, {}).regions.empty());
}

TEST(CompareSurfaces, TellsWhatIsNotSeenFromWhatIsBlocked) {
  SurfaceMap part = FlatLot();
  std::erase_if(part.cells, [](const SurfaceCell& cell) { return cell.x >= 150; });
  const SurfaceChanges grown = CompareSurfaces(part, FlatLot(), {});
  ASSERT_EQ(grown.regions.size(), 1U);
  EXPECT_EQ(grown.regions[0].change, GroundChange::kMapped);
  EXPECT_NEAR(grown.regions[0].area, 5 * 15, 5);  // a cell just off the border is found there
  const SurfaceChanges shrunk = CompareSurfaces(FlatLot(), part, {});
  ASSERT_EQ(shrunk.regions.size(), 1U);
  EXPECT_EQ(shrunk.regions[0].change, GroundChange::kUnmapped);
  EXPECT_NEAR(shrunk.regions[0].area, 5 * 15, 5);
}

TEST(CompareSurfaces, MeasuresHeightsThatChanged) {
  SurfaceMap after = FlatLot();
  ChangeInside(after, 5, 9, 5, 9, [](SurfaceCell& cell) { cell.height = 0.12F; });
  ChangeInside(after, 12, 16, 5, 9, [](SurfaceCell& cell) {
    cell.height = 0.12F;
    cell.height_sigma = 0.2F;
  });
  const SurfaceChanges changes = CompareSurfaces(FlatLot(), after, {});
  ASSERT_EQ(changes.regions.size(), 1U) << "what may be an error is none";
  EXPECT_EQ(changes.regions[0].change, GroundChange::kRaised);
  EXPECT_NEAR(changes.regions[0].height_change, 0.12, 1e-6);
  EXPECT_NEAR(changes.height.percentile_95, 0.12, 1e-6);
  EXPECT_NEAR(changes.height.median, 0, 1e-6);
}

TEST(CompareSurfaces, ReportsNothingThatTheAlignmentMayHaveMade) {
  SurfaceMap before = FlatLot(), after = FlatLot();
  for (SurfaceCell& cell : after.cells) cell.height = 0.8F;  // all of it
  ChangeInside(after, 0, 20, 0, 1,
               [](SurfaceCell& cell) { cell.free_belief = 0.05F; });  // one border
  ChangeInside(before, 5, 10, 5, 12,
               [](SurfaceCell& cell) { cell.free_belief = 0.05F; });  // a van and more
  EXPECT_EQ(CompareSurfaces(before, after, {}).regions.size(), 2U);
  const SurfaceChanges changes = CompareSurfaces(before, after, {{}, 0.5, 0.4});
  ASSERT_EQ(changes.regions.size(), 1U);
  EXPECT_EQ(changes.regions[0].change, GroundChange::kFreed);
  EXPECT_NEAR(changes.height.median, 0.8, 1e-6) << "which is said, but not called a change";
}

TEST(CompareSurfaces, TellsRaisedGroundFromPosesThatDrift) {
  SurfaceMap after = FlatLot();
  // A deck that is off, with a ramp of 10 m to it, and a mound on either side.
  for (SurfaceCell& cell : after.cells)
    cell.height = 0.06F * std::clamp(0.1F * (static_cast<float>(cell.x) * 0.1F - 5), 0.0F, 1.0F);
  ChangeInside(after, 1, 3, 4, 7, [](SurfaceCell& cell) { cell.height += 0.12F; });
  ChangeInside(after, 17, 19, 8, 11, [](SurfaceCell& cell) { cell.height -= 0.12F; });
  const SurfaceChanges changes = CompareSurfaces(FlatLot(), after, {});
  ASSERT_EQ(changes.regions.size(), 2U);
  EXPECT_EQ(changes.regions[0].change, GroundChange::kRaised);
  EXPECT_NEAR(changes.regions[0].area, 6, 0.3);
  EXPECT_NEAR(changes.regions[0].height_change, 0.12, 0.02);
  EXPECT_EQ(changes.regions[1].change, GroundChange::kLowered);
  EXPECT_NEAR(changes.regions[1].area, 6, 0.3);
  EXPECT_NEAR(changes.regions[1].height_change, -0.12, 0.02);
  EXPECT_NEAR(changes.height.percentile_95, 0.06, 0.01) << "which is said, but not called a change";
}

TEST(CompareSurfaces, WorksInTheLaterSite) {
  SurfaceMap before = FlatLot();
  ParkCar(before, 3, 2);
  // The earlier site lies turned by a right angle, and elsewhere.
  const Rigid3 to_from_from{
      Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())),
      Eigen::Vector3d(40, -5, 2)};
  SurfaceMap after{kCell, {}};
  for (const SurfaceCell& cell : FlatLot().cells) {
    const Eigen::Vector3d moved =
        to_from_from * Eigen::Vector3d((cell.x + 0.5) * kCell, (cell.y + 0.5) * kCell, 0);
    after.cells.push_back(cell);
    after.cells.back().x = static_cast<int>(std::floor(moved.x() / kCell));
    after.cells.back().y = static_cast<int>(std::floor(moved.y() / kCell));
    after.cells.back().height = 2;
  }
  std::sort(after.cells.begin(), after.cells.end(), [](const SurfaceCell& a, const SurfaceCell& b) {
    return std::pair(a.y, a.x) < std::pair(b.y, b.x);
  });
  const SurfaceChanges changes = CompareSurfaces(before, after, {to_from_from});
  ASSERT_EQ(changes.regions.size(), 1U);
  EXPECT_EQ(changes.regions[0].change, GroundChange::kFreed);
  EXPECT_NEAR((changes.regions[0].center - Eigen::Vector3d(40 - 4.2, -5 + 3.9, 2)).norm(), 0, 0.1);
}

TEST(CompareSurfaces, KeepsDecksApart) {
  SurfaceMap before{kCell, {}}, after{kCell, {}};
  for (const SurfaceCell& cell : FlatLot().cells)
    for (const float deck : {0.0F, 2.8F}) {
      before.cells.push_back(cell);
      before.cells.back().height = deck;
    }
  after = before;
  ChangeInside(after, 3, 4.8, 2, 6.4, [](SurfaceCell& cell) {
    if (cell.height > 1) cell.free_belief = 0.05F;
  });
  const SurfaceChanges changes = CompareSurfaces(before, after, {});
  ASSERT_EQ(changes.regions.size(), 1U);
  EXPECT_NEAR(changes.regions[0].center.z(), 2.8, 1e-6);
}

TEST(CompareSurfaces, RefusesOptionsThatMakeNoSense) {
  CompareOptions options;
  options.sure_belief = 0.4;
  EXPECT_THROW(CompareSurfaces(FlatLot(), FlatLot(), {}, options), Error);
}

}  // namespace
}  // namespace parkade
