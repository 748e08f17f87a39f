#include "mapping/surface/fuse_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "core/error.h"
#include "mapping/surface/surface_painter.h"
#include "tests/mapping/worlds/fuse_patches.h"
#include "tests/mapping/worlds/synthetic_drive.h"

namespace parkade {
namespace {

/// A straight, flat drive from x = 0 to `length`.
DrivenPath MakePath(double length) {
  const Rig rig = MakeTestRig();
  std::vector<TrajectoryState> states;
  for (double x = 0; x <= length; x += 0.1) {
    TrajectoryState& state = states.emplace_back();
    state.time = TimestampFromSeconds(x);
    state.world_from_body.translation.x() = x;
  }
  return MakeDrivenPath(0, rig, Trajectory(states), Rigid3{});
}

/// Samples every 5 cm of [x0, x1] x [y0, y1] on z = 0 of the body.
PosedGroundPatch MakePatch(double x0, double y0, double x1, double y1, std::uint8_t gray,
                           bool is_free) {
  PosedGroundPatch posed;
  for (double x = x0 + 0.025; x < x1; x += 0.05)
    for (double y = y0 + 0.025; y < y1; y += 0.05)
      posed.patch.samples.push_back(
          GroundSample{.point_in_body = Eigen::Vector3f(Eigen::Vector3d(x, y, 0).cast<float>()),
                       .blue = gray,
                       .green = gray,
                       .red = gray,
                       .is_free = is_free,
                       .weight = 1000});
  return posed;
}

/// What is asked here is what observations say; the network of outlines has tests of its own.
SurfaceOptions ObservationsAlone() {
  SurfaceOptions options;
  options.outlines = "observations";
  return options;
}

const SurfaceCell* CellAt(const SurfaceMap& surface, double x, double y) {
  const int cx = static_cast<int>(std::floor(x / surface.cell_size)),
            cy = static_cast<int>(std::floor(y / surface.cell_size));
  for (const SurfaceCell& cell : surface.cells)
    if (cell.x == cx && cell.y == cy) return &cell;
  return nullptr;
}

TEST(FuseSurface, WhatWasNeverSeenIsNotInTheMap) {
  const DrivenPath path = MakePath(5);
  const std::vector patches{MakePatch(3, -2, 8, 2, 100, true)};

  const SurfaceMap surface = FuseSurface(patches, std::span(&path, 1), ObservationsAlone());

  EXPECT_NE(CellAt(surface, 6, 1), nullptr);
  EXPECT_EQ(CellAt(surface, 6, 3), nullptr);
}

TEST(FuseSurface, SamplesBeyondTheOutlineSayNothing) {
  const DrivenPath path = MakePath(5);
  std::vector<PosedGroundPatch> patches{MakePatch(3, -2, 8, 2, 100, true)};
  for (const char* method : {"surface", "homography"}) {
    SurfaceOptions options = ObservationsAlone();
    options.method = method;
    const SurfaceMap before = FuseSurface(patches, std::span(&path, 1), options);
    std::vector<PosedGroundPatch> with_beyond = patches;
    for (GroundSample sample : MakePatch(3, 1, 8, 4, 30, false).patch.samples) {
      sample.confidence = 0;
      with_beyond[0].patch.samples.push_back(sample);
    }
    const SurfaceMap after = FuseSurface(with_beyond, std::span(&path, 1), options);
    ASSERT_EQ(after.cells.size(), before.cells.size()) << method;
    for (size_t i = 0; i < before.cells.size(); ++i) {
      EXPECT_EQ(after.cells[i].color, before.cells[i].color);
      EXPECT_EQ(after.cells[i].free_belief, before.cells[i].free_belief);
    }
  }
}

TEST(FuseSurface, SamplesThatCannotTellChangeNothingWithoutANetwork) {
  const DrivenPath path = MakePath(5);
  std::vector<PosedGroundPatch> patches{MakePatch(3, -2, 8, 2, 100, true)};
  const SurfaceMap before = FuseSurface(patches, std::span(&path, 1), ObservationsAlone());
  for (GroundSample sample : MakePatch(3, 0, 8, 4, 100, true).patch.samples) {
    sample.confidence = 0;
    patches[0].patch.samples.push_back(sample);
  }
  const SurfaceMap after = FuseSurface(patches, std::span(&path, 1), ObservationsAlone());
  ASSERT_GT(before.cells.size(), 1000U);
  ASSERT_EQ(after.cells.size(), before.cells.size());
  for (size_t i = 0; i < before.cells.size(); ++i)
    EXPECT_NEAR(after.cells[i].free_belief, before.cells[i].free_belief, 1e-5);
}

TEST(FuseSurface, SamplesThatCannotTellAreSeenByTheNetwork) {
  const DrivenPath path = MakePath(5);
  std::vector<PosedGroundPatch> patches{MakePatch(3, -2, 8, 2, 100, true)};
  for (GroundSample sample : MakePatch(3, 2.5, 8, 4, 100, true).patch.samples) {
    sample.confidence = 0;
    patches[0].patch.samples.push_back(sample);
  }
  const SurfaceMap surface = FuseSurface(patches, std::span(&path, 1));
  ASSERT_NE(CellAt(surface, 6, 1), nullptr);
  ASSERT_NE(CellAt(surface, 6, 3), nullptr);
  EXPECT_EQ(CellAt(surface, 6, 3)->color, CellAt(surface, 6, 1)->color);
}

TEST(FuseSurface, AMovedCarTurnsIntoFreeSpaceAgain) {
  const DrivenPath path = MakePath(5);
  std::vector<PosedGroundPatch> patches{MakePatch(3, -3, 8, 3, 100, true)};
  for (int i = 0; i < 6; ++i) patches.push_back(MakePatch(5, 1.5, 6, 2.5, 20, false));

  const SurfaceMap with_car = FuseSurface(patches, std::span(&path, 1), ObservationsAlone());
  for (int i = 0; i < 20; ++i) patches.push_back(MakePatch(5, 1.5, 6, 2.5, 100, true));
  const SurfaceMap after = FuseSurface(patches, std::span(&path, 1), ObservationsAlone());

  EXPECT_LT(CellAt(with_car, 5.5, 2)->free_belief, 0.2F);
  EXPECT_GT(CellAt(after, 5.5, 2)->free_belief, 0.8F);
}

TEST(FuseSurface, ACarThatParksWhereAnotherDroveBlocksIt) {
  std::vector<DrivenPath> paths{MakePath(10), MakePath(3)};
  paths[1].drive = 1;
  std::vector<PosedGroundPatch> patches{MakePatch(0, -3, 12, 3, 100, true)};
  const auto add_day = [&](int drive, bool is_free) {
    for (int i = 0; i < 30; ++i) {
      patches.push_back(MakePatch(6, -1, 8, 1, 20, is_free));
      patches.back().patch.drive = drive;
    }
  };
  add_day(0, true);
  add_day(1, false);
  const SurfaceMap blocked = FuseSurface(patches, paths, ObservationsAlone());
  EXPECT_LT(CellAt(blocked, 7, 0.2)->free_belief, 0.2F);

  patches.resize(31);
  const SurfaceMap driven = FuseSurface(patches, paths, ObservationsAlone());
  EXPECT_GT(CellAt(driven, 7, 0.2)->free_belief, 0.8F);
  EXPECT_GT(CellAt(driven, 2, 0.2)->free_belief, 0.8F)
      << "the second drive saw nothing, but drove here";
}

TEST(FuseSurface, WhatTheLatestDriveSeesFromAfarCountsAgainstAllBefore) {
  std::vector<DrivenPath> paths{MakePath(10), MakePath(10), MakePath(10)};
  std::vector<PosedGroundPatch> patches{MakePatch(0, -3, 12, 3, 100, true)};
  const auto add_day = [&](int drive, bool is_free, int count, float confidence) {
    paths[static_cast<size_t>(drive)].drive = drive;
    for (int i = 0; i < count; ++i) {
      PosedGroundPatch posed = MakePatch(6, 1.5, 8, 2.5, 20, is_free);
      posed.patch.drive = drive;
      for (GroundSample& sample : posed.patch.samples) sample.confidence = confidence;
      patches.push_back(posed);
    }
  };
  add_day(0, true, 30, 1);
  add_day(1, true, 1, 0.03F);
  add_day(1, false, 2, 0.03F);
  EXPECT_GT(CellAt(FuseSurface(patches, paths, ObservationsAlone()), 7, 2)->free_belief, 0.9F)
      << "a glance is not enough";
  add_day(2, false, 12, 0.03F);
  EXPECT_LT(CellAt(FuseSurface(patches, paths, ObservationsAlone()), 7, 2)->free_belief, 0.5F);
}

TEST(FuseSurface, WhatLiesBeyondAnOutlineCoversWhatAnEarlierDriveSaw) {
  std::vector<DrivenPath> paths{MakePath(10), MakePath(10)};
  paths[1].drive = 1;
  std::vector<PosedGroundPatch> patches{MakePatch(-1, -2, 12, 7, 100, true)};
  for (const int drive : {0, 1})
    for (double x = 3; x <= 7; x += 0.5) {
      PosedGroundPatch posed = MakePatch(4 - x, 2, 6 - x, 6, drive == 0 ? 100 : 240, drive == 0);
      posed.patch.drive = drive;
      posed.site_from_body.translation.x() = x;
      if (drive == 1)
        for (GroundSample& sample : posed.patch.samples) sample.confidence = 0;
      patches.push_back(posed);
    }
  const SurfaceMap covered = FuseSurface(patches, paths, ObservationsAlone());
  EXPECT_LT(CellAt(covered, 5, 4.5)->free_belief, 0.35F);
  EXPECT_EQ(CellAt(covered, 5, 4.5)->color[0], 100) << "it is no observation of the ground";
}

TEST(FuseSurface, ASlotThatCannotBeSeenAnyMoreIsCovered) {
  std::vector<DrivenPath> paths{MakePath(10), MakePath(10), MakePath(10)};
  for (int drive = 0; drive < 3; ++drive) paths[static_cast<size_t>(drive)].drive = drive;
  // A slot beside the path, seen in passing; of a car in it only the foot counts, the rest is
  // hidden.
  const auto pass = [&](int drive, bool is_free, double begin, double end) {
    std::vector<PosedGroundPatch> patches;
    for (double x = begin; x <= end; x += 0.5) {
      PosedGroundPatch posed = MakePatch(4 - x, 2, 6 - x, 6, 100, is_free);
      posed.patch.drive = drive;
      posed.site_from_body.translation.x() = x;
      for (GroundSample& sample : posed.patch.samples)
        if (!is_free && sample.point_in_body.y() > 2.3F) sample.confidence = 0.03F;
      patches.push_back(posed);
    }
    return patches;
  };
  std::vector<PosedGroundPatch> patches{MakePatch(-1, -2, 12, 7, 100, true)};
  const auto add = [&](const std::vector<PosedGroundPatch>& more) {
    patches.insert(patches.end(), more.begin(), more.end());
  };
  add(pass(0, true, 1, 9));
  add(pass(1, false, 1, 9));
  const SurfaceMap covered = FuseSurface(patches, paths, ObservationsAlone());
  EXPECT_LT(CellAt(covered, 5, 4.5)->free_belief, 0.35F);
  EXPECT_GT(CellAt(covered, 8, 4.5)->free_belief, 0.5F) << "the slot beside it";

  add(pass(2, true, 1, 9));
  EXPECT_GT(CellAt(FuseSurface(patches, paths, ObservationsAlone()), 5, 4.5)->free_belief, 0.65F)
      << "the car has gone";
}

TEST(FuseSurface, WhatIsHiddenFromElsewhereIsNotCovered) {
  std::vector<DrivenPath> paths{MakePath(10), MakePath(10)};
  paths[1].drive = 1;
  std::vector<PosedGroundPatch> patches{MakePatch(-1, -2, 12, 7, 100, true)};
  const auto look = [&](int drive, const Eigen::Vector3d& from, bool is_free) {
    PosedGroundPatch posed =
        MakePatch(4 - from.x(), 2 - from.y(), 6 - from.x(), 6 - from.y(), 100, is_free);
    posed.patch.drive = drive;
    posed.site_from_body.translation = from;
    for (GroundSample& sample : posed.patch.samples)
      if (!is_free) sample.confidence = 0.03F;
    patches.push_back(posed);
  };
  for (const double x : {3.0, 4.0, 5.0, 6.0, 7.0}) look(0, {x, 0, 0}, true);
  for (const double x : {3.0, 4.0, 5.0, 6.0, 7.0})
    look(1, {x, 12, 0}, false);  // from the other side of a hedge
  EXPECT_GT(CellAt(FuseSurface(patches, paths, ObservationsAlone()), 5, 4.5)->free_belief, 0.65F);
}

TEST(FuseSurface, OneOddObservationDoesNotColorACell) {
  const DrivenPath path = MakePath(5);
  std::vector<PosedGroundPatch> patches;
  for (int i = 0; i < 4; ++i) patches.push_back(MakePatch(3, -2, 8, 2, 100, true));
  patches.push_back(MakePatch(3, -2, 8, 2, 250, true));  // a reflection

  const SurfaceMap surface = FuseSurface(patches, std::span(&path, 1), ObservationsAlone());

  EXPECT_EQ(CellAt(surface, 6, 1)->color[0], 100);
}

TEST(FuseSurface, ACellHasTheColorOfTheLatestDriveThatSawIt) {
  const DrivenPath path = MakePath(5);
  std::vector<PosedGroundPatch> patches;
  for (int i = 0; i < 4; ++i) patches.push_back(MakePatch(3, -2, 8, 2, 100, true));
  patches.push_back(MakePatch(3, -2, 8, 0, 130, true));  // at dusk, one observation
  patches.back().patch.drive = 1;

  const SurfaceMap surface = FuseSurface(patches, std::span(&path, 1), ObservationsAlone());

  EXPECT_EQ(CellAt(surface, 6, -1)->color[0], 130);
  EXPECT_EQ(CellAt(surface, 6, 1)->color[0], 100);
}

TEST(FuseSurface, ADriveElsewhereDoesNotAgeACellWhateverTheTiles) {
  std::vector<HeightObservation> flat;
  for (double x = -2; x < 30; x += 0.4)
    for (double y = -4; y < 4; y += 0.4) flat.push_back({{x, y, 0}, 1e4});
  std::vector<PosedGroundPatch> patches{MakePatch(3, -2, 8, 2, 100, true),
                                        MakePatch(22, -2, 27, 2, 150, true),
                                        MakePatch(3, -2, 8, 2, 200, true)};
  for (size_t i = 0; i < patches.size(); ++i) patches[i].patch.drive = static_cast<int>(i);
  for (GroundSample& sample : patches[2].patch.samples)
    sample.weight = 1e-4F * sample.weight;  // from afar: a tenth as near
  for (const double tile_size : {6.0, 1000.0}) {
    SurfaceOptions options = ObservationsAlone();
    options.tile_size = tile_size;
    options.min_island_area = 0;  // nobody drives here
    const SurfaceMap surface = FuseSurface(PatchesInMemory(patches), {}, {}, options, flat);
    EXPECT_EQ(CellAt(surface, 6, 1)->color[0], 100) << tile_size;
    EXPECT_EQ(CellAt(surface, 25, 1)->color[0], 150) << tile_size;
  }
}

TEST(FuseSurface, WhatACarDroveOverIsFreeWhateverWasSeen) {
  const DrivenPath path = MakePath(5);
  std::vector<PosedGroundPatch> patches{MakePatch(0, -3, 8, 3, 100, true)};
  for (int i = 0; i < 20; ++i) patches.push_back(MakePatch(2, -0.5, 4, 0.5, 30, false));

  const SurfaceMap surface = FuseSurface(patches, std::span(&path, 1), ObservationsAlone());

  EXPECT_GT(CellAt(surface, 3, 0)->free_belief, 0.9F);
}

TEST(FuseSurface, TheGroundUnderTheCarAtTheStartIsFilled) {
  const DrivenPath path = MakePath(0.05);  // stands: nothing was ever seen below it
  const std::vector patches{
      MakePatch(-3, -3, -0.5, 3, 100, true), MakePatch(3.2, -3, 6, 3, 100, true),
      MakePatch(-0.5, 1.2, 3.2, 3, 100, true), MakePatch(-0.5, -3, 3.2, -1.2, 100, true)};

  const SurfaceMap surface = FuseSurface(patches, std::span(&path, 1), ObservationsAlone());

  EXPECT_EQ(CellAt(surface, -0.2, 0.0), nullptr) << "not between the wheels";
  EXPECT_EQ(CellAt(surface, 1.3, 0.0), nullptr) << "nothing seen is near enough to lend its color";
}

TEST(FuseSurface, SmallIslandsThatNoCarReachedAreDropped) {
  const DrivenPath path = MakePath(5);
  const std::vector patches{MakePatch(-1, -3, 8, 3, 100, true), MakePatch(2, 6, 3, 7, 100, true),
                            MakePatch(1, -10, 5, -6, 100, true)};
  SurfaceOptions options = ObservationsAlone();
  options.min_island_area = 10;
  const SurfaceMap sure = FuseSurface(patches, std::span(&path, 1), options);
  options.max_height_sigma = 1;

  const SurfaceMap surface = FuseSurface(patches, std::span(&path, 1), options);

  EXPECT_EQ(CellAt(surface, 2.5, 6.5), nullptr) << "1 m^2";
  EXPECT_NE(CellAt(surface, 3, -7), nullptr) << "16 m^2";
  EXPECT_EQ(CellAt(sure, 3, -7), nullptr) << "nobody measured its height";
}

TEST(FuseSurface, CellsAreSortedAsPromised) {
  const DrivenPath path = MakePath(5);
  const std::vector patches{MakePatch(-1, -3, 8, 3, 100, true)};

  const SurfaceMap surface = FuseSurface(patches, std::span(&path, 1), ObservationsAlone());

  EXPECT_TRUE(std::is_sorted(surface.cells.begin(), surface.cells.end(),
                             [](const SurfaceCell& a, const SurfaceCell& b) {
                               return std::tie(a.y, a.x, a.height) < std::tie(b.y, b.x, b.height);
                             }));
}

TEST(FuseSurface, NothingInNothingOut) { EXPECT_TRUE(FuseSurface({}, {}).cells.empty()); }

TEST(FuseSurface, RejectsCellsThatDoNotDivideTheHeightField) {
  SurfaceOptions options = ObservationsAlone();
  options.cell_size = 0.07;
  EXPECT_THROW(FuseSurface({}, {}, options), Error);
}

/// Level ground between two corners [m].
HeightField FlatField(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  std::vector<HeightObservation> flat;
  for (double x = low.x(); x < high.x(); x += 0.4)
    for (double y = low.y(); y < high.y(); y += 0.4) flat.push_back({{x, y, 0}, 1e4});
  return {std::move(flat), {}};
}

TEST(SurfacePainter, EveryCellThatTheCarStoodOnIsDriven) {
  // In bends of both directions, there and back again in reverse.
  std::vector<TrajectoryState> states;
  Rigid3 pose;
  for (int i = 0; i < 600; ++i) {
    states.push_back({.time = TimestampFromSeconds(0.1 * i), .world_from_body = pose});
    const double yaw = 0.02 * std::sin(0.02 * i), step = i < 400 ? 0.03 : -0.03;
    pose = pose * Rigid3{ExpSo3({0, 0, yaw}), {step, 0, 0}};
  }
  const DrivenPath path = MakeDrivenPath(0, MakeTestRig(), Trajectory(states), Rigid3{});
  const HeightField field = FlatField({-10, -15}, {25, 15});

  SurfacePainter painter(field, 8, {});
  painter.MarkDriven(path);

  std::set<std::pair<int, int>> driven, stood_on;
  for (const SurfacePainter::PaintedCell& cell : painter.Cells())
    if (cell.is_driven) driven.emplace(cell.cell.x, cell.cell.y);
  std::optional<Eigen::Vector3d> last;
  for (const TrajectoryState& state : path.site_from_body.states()) {
    if (last && (state.world_from_body.translation - *last).norm() < 0.1) continue;
    last = state.world_from_body.translation;
    for (double x = 0; x <= path.contact.wheelbase; x += 0.035)
      for (double y = -0.5 * path.contact.track; y <= 0.5 * path.contact.track; y += 0.035) {
        const Eigen::Vector3d point = state.world_from_body * Eigen::Vector3d(x, y, 0);
        stood_on.emplace(static_cast<int>(std::floor(point.x() / 0.05)),
                         static_cast<int>(std::floor(point.y() / 0.05)));
      }
  }
  std::vector<std::pair<int, int>> different;
  std::set_symmetric_difference(driven.begin(), driven.end(), stood_on.begin(), stood_on.end(),
                                std::back_inserter(different));
  EXPECT_GT(driven.size(), 10000u);
  EXPECT_LT(different.size(), 3u) << "but for points that rounding puts to either side";
}

TEST(SurfacePainter, ACarOfUnknownSizeIsASmallOne) {
  std::vector<TrajectoryState> states;
  for (int i = 0; i <= 100; ++i)
    states.push_back({.time = TimestampFromSeconds(0.1 * i),
                      .world_from_body = {Eigen::Quaterniond::Identity(), {0.1 * i, 0, 0}}});
  DrivenPath path = MakeDrivenPath(0, MakeTestRig(), Trajectory(states), Rigid3{});
  path.contact = {};
  const HeightField field = FlatField({-4, -4}, {16, 4});

  SurfacePainter painter(field, 8, {});
  painter.MarkDriven(path);

  int num_driven = 0;
  for (const SurfacePainter::PaintedCell& cell : painter.Cells()) num_driven += cell.is_driven;
  EXPECT_NEAR(num_driven * 0.05 * 0.05, (10 + 1.6) * 1.1, 0.8) << "m^2, without gaps";
}

TEST(SurfacePainter, ASampleMovesAlongItsRayOntoARampAhead) {
  // A ramp of 10 % from x = 2 on; an eye 1 m above the level sees its point (4, 0, 0.2) on the
  // level at x = 5.
  std::vector<HeightObservation> heights;
  for (double x = -2; x < 12; x += 0.1)
    for (double y = -1; y < 1; y += 0.1)
      heights.push_back({{x, y, std::max(0.0, 0.1 * (x - 2))}, 1000});
  HeightFieldOptions stiff;
  stiff.curvature_sigma = 10;  // let it have the kink
  const HeightField field(heights, stiff);
  DrivenPath path = MakePath(1);
  path.cameras_in_body = {{0, 0, 1}};
  PosedGroundPatch posed;
  posed.patch.samples.push_back(GroundSample{.point_in_body = Eigen::Vector3f(5, 0.02F, 0),
                                             .blue = 9,
                                             .green = 9,
                                             .red = 9,
                                             .is_free = true,
                                             .weight = 1000});

  SurfacePainter painter(field, 8, {});
  painter.PaintDrive(PatchesInMemory(std::span(&posed, 1)), std::vector<size_t>{0}, &path);

  int num_seen = 0;
  for (const SurfacePainter::PaintedCell& cell : painter.Cells()) {
    if (!cell.is_seen) continue;
    ++num_seen;
    EXPECT_NEAR((cell.cell.x + 0.5) * 0.05, 4.0, 0.08);
  }
  EXPECT_EQ(num_seen, 1);
}

}  // namespace
}  // namespace parkade
