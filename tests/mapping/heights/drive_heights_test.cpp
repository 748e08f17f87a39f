#include "mapping/heights/drive_heights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "mapping/heights/moved_heights.h"
#include "mapping/observation/observe_ground.h"
#include "mapping/surface/fuse_surface.h"
#include "tests/mapping/worlds/synthetic_drive.h"

namespace parkade {
namespace {

/// A drive through a lot, along x from -18 m on.
struct SeenDrive {
  explicit SeenDrive(double length)
      : drive(scene, MakeTestRig(), DriveAlong(scene, {-18, 0, 0}, 0, {{length, 0}}, MakeTestRig()),
              true) {}

  SyntheticScene scene = MakeLot();
  SyntheticDrive drive;
  GroundObservation seen = ObserveGround(drive, drive.trajectory(), {}, 0);

  DrivenPath Path(int number, const Rigid3& site_from_odom) const {
    std::vector<TrajectoryState> states = drive.trajectory().states();
    for (TrajectoryState& state : states)
      state.world_from_body = site_from_odom * state.world_from_body;
    return MakeDrivenPath(number, drive.rig(), Trajectory(states), seen.body_from_ground);
  }

  std::vector<PosedGroundPatch> Patches(int number, const Rigid3& site_from_odom) const {
    std::vector<PosedGroundPatch> posed;
    for (const GroundPatch& patch : seen.patches) {
      posed.push_back({patch, site_from_odom * drive.trajectory().At(patch.time).value()});
      posed.back().patch.drive = number;
    }
    return posed;
  }
};

/// Seen once for most tests.
const SeenDrive& Seen() {
  static const SeenDrive seen(12);
  return seen;
}

/// A drive as its poses have it.
struct PosedDrive {
  DrivenPath path;
  std::vector<PosedGroundPatch> patches;
};

/// The same ground, turned and moved.
Rigid3 Moved() {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())),
          Eigen::Vector3d(30.13, -7.31, 2.4)};
}

/// [m] RMS between the heights of two fields at places along the drive, which lies somewhere else
/// in each of them.
double Difference(const HeightField& a, const Rigid3& a_from_odom, const HeightField& b,
                  const Rigid3& b_from_odom, std::pair<double, double> along = {-16, -4}) {
  double sum = 0;
  int count = 0;
  for (double x = along.first; x < along.second; x += 0.7)
    for (double y = -6; y < 6; y += 0.7) {
      Eigen::Vector3d in_a = a_from_odom * Eigen::Vector3d(x, y, 0);
      double height_a = 0, height_b = 0;
      if (a.FindPatch(in_a, height_a) == HeightField::kNone) continue;
      in_a.z() = height_a;
      const Eigen::Vector3d in_b = b_from_odom * (a_from_odom.Inverse() * in_a);
      if (b.FindPatch(in_b, height_b) == HeightField::kNone) continue;
      sum += std::pow(height_b - in_b.z(), 2);
      ++count;
    }
  EXPECT_GT(count, 150);
  return std::sqrt(sum / std::max(count, 1));
}

TEST(DriveHeights, MoveWithThePathOfTheirDrive) {
  const DrivenPath path = Seen().Path(0, {}), moved = Seen().Path(0, Moved());
  const std::vector<PosedGroundPatch> patches = Seen().Patches(0, {});
  const DriveHeights heights = MeasureDriveHeights(PatchesInMemory(patches), &path, {});
  ASSERT_GT(heights.swept.size(), 100u);

  const HeightField here = FitHeights(std::span(&heights, 1), std::span(&path, 1), {});
  const HeightField there = FitHeights(std::span(&heights, 1), std::span(&moved, 1), {});

  EXPECT_LT(Difference(here, {}, there, Moved()), 0.003)
      << "the grid lies elsewhere on the ground, no more";
}

TEST(DriveHeights, AreTheSameWhereverTheDriveIsMeasured) {
  const DrivenPath path = Seen().Path(0, {}), moved = Seen().Path(0, Moved());
  const std::vector<PosedGroundPatch> patches = Seen().Patches(0, {}),
                                      moved_patches = Seen().Patches(0, Moved());
  const DriveHeights measured = MeasureDriveHeights(PatchesInMemory(patches), &path, {});
  const DriveHeights measured_there =
      MeasureDriveHeights(PatchesInMemory(moved_patches), &moved, {});

  const HeightField kept = FitHeights(std::span(&measured, 1), std::span(&moved, 1), {});
  const HeightField anew = FitHeights(std::span(&measured_there, 1), std::span(&moved, 1), {});

  EXPECT_LT(Difference(kept, Moved(), anew, Moved()), 0.01);
}

/// With all poses beyond x = `begin` [m] lifted by `lift` [m].
PosedDrive Lifted(const SeenDrive& seen, double begin, double lift) {
  PosedDrive lifted{seen.Path(0, {}), seen.Patches(0, {})};
  const auto raise = [&](Rigid3& pose) {
    if (pose.translation.x() > begin) pose.translation.z() += lift;
  };
  std::vector<TrajectoryState> states = lifted.path.site_from_body.states();
  for (TrajectoryState& state : states) raise(state.world_from_body);
  lifted.path.site_from_body = Trajectory(std::move(states));
  for (PosedGroundPatch& posed : lifted.patches) raise(posed.site_from_body);
  return lifted;
}

TEST(DriveHeights, AreMeasuredAgainWhereThePathMoved) {
  const SeenDrive seen(30);
  const PosedDrive before = Lifted(seen, 4, 0), now = Lifted(seen, 4, 0.008);
  const DriveHeights measured =
      MeasureDriveHeights(PatchesInMemory(before.patches), &before.path, {});
  const MovedHeights moved = FindMovedHeights(measured, now.path.site_from_body, {});
  ASSERT_EQ(moved.worth, HeightsWorth::kSome);
  EXPECT_FALSE(moved.squares.Has({-16, 0, 0})) << "not seen from where the path moved";
  EXPECT_TRUE(moved.squares.Has({6, 0, 0}));

  const PatchesInMemory patches(now.patches);
  const DriveHeights again = MeasureMovedHeights(patches, now.path, {}, measured, moved.squares);

  ASSERT_EQ(again.along.size(), 2u);
  EXPECT_GT(again.along[0].num_swept, 100u) << "kept";
  EXPECT_GT(again.along[1].num_swept, 100u) << "measured again";
  EXPECT_EQ(FindMovedHeights(again, now.path.site_from_body, {}).worth, HeightsWorth::kHold);
  const DriveHeights anew = MeasureDriveHeights(patches, &now.path, {});
  EXPECT_NEAR(static_cast<double>(again.swept.size()), static_cast<double>(anew.swept.size()),
              0.03 * static_cast<double>(anew.swept.size()));
  const auto fit = [&](const DriveHeights& heights) {
    return FitHeights(std::span(&heights, 1), std::span(&now.path, 1), {});
  };
  EXPECT_LT(Difference(fit(again), {}, fit(anew), {}, {-16, 10}), 0.003);
}

TEST(DriveHeights, OfTwoDrivesDoNotDependOnTheirOrder) {
  const std::vector<DrivenPath> paths{Seen().Path(0, {}), Seen().Path(1, {})};
  std::vector<DriveHeights> heights;
  for (int drive = 0; drive < 2; ++drive) {
    const std::vector<PosedGroundPatch> patches = Seen().Patches(drive, {});
    heights.push_back(
        MeasureDriveHeights(PatchesInMemory(patches), &paths[static_cast<size_t>(drive)], {}));
    EXPECT_EQ(heights.back().drive, drive);
  }

  const HeightField both = FitHeights(heights, paths, {});
  std::swap(heights[0], heights[1]);
  const HeightField swapped = FitHeights(heights, paths, {});
  const HeightField alone = FitHeights(std::span(heights).first(1), std::span(paths).last(1), {});

  EXPECT_LT(Difference(both, {}, swapped, {}), 1e-6);
  EXPECT_LT(Difference(both, {}, alone, {}), 0.002) << "the same seen twice";
}

TEST(FuseSurface, TheTilesLeaveNoTrace) {
  const DrivenPath path = Seen().Path(0, Moved());
  const std::vector<PosedGroundPatch> patches = Seen().Patches(0, Moved());
  const PatchesInMemory source(patches);
  SurfaceOptions options;
  const DriveHeights heights = MeasureDriveHeights(source, &path, options.Heights());
  options.tile_size = 1000;
  const SurfaceMap whole =
      FuseSurface(source, std::span(&path, 1), std::span(&heights, 1), options);

  options.tile_size = 6;
  const SurfaceMap tiled =
      FuseSurface(source, std::span(&path, 1), std::span(&heights, 1), options);

  ASSERT_GT(whole.cells.size(), 10000u);
  ASSERT_EQ(tiled.cells.size(), whole.cells.size());
  for (size_t i = 0; i < whole.cells.size(); ++i) {
    const SurfaceCell &a = whole.cells[i], &b = tiled.cells[i];
    ASSERT_TRUE(a.x == b.x && a.y == b.y && a.height == b.height &&
                a.height_sigma == b.height_sigma && a.free_belief == b.free_belief &&
                a.color == b.color)
        << i;
  }
}

}  // namespace
}  // namespace parkade
