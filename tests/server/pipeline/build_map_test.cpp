#include "server/pipeline/build_map.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "server/pipeline/plan_stages.h"
#include "server/pipeline/prepare_drive.h"
#include "server/pipeline/report.h"
#include "tests/server/store/temporary_store.h"
#include "tests/server/worlds/memory_drive.h"

namespace parkade {
namespace {

using Drives = std::vector<std::unique_ptr<RecordedDrive>>;

constexpr double kDuration = 7;  // [s], of which the car stands for two

class BuildMapTest : public testing::Test {
 protected:
  BuildMapTest() { std::filesystem::remove_all(root_); }
  ~BuildMapTest() override { std::filesystem::remove_all(root_); }

  /// Trajectories only, into the folder `to`.
  BuiltMap Build(const Drives& drives, const std::string& to, const std::string& from = "",
                 const std::string& work = "") {
    const BuildScope scope = ScopeOf(to, from, work);
    Progress progress(PlanStages(drives.size(), true), {});
    BuiltMap built = BuildMap(drives, options_, scope, progress);
    progress.Finish();
    timings_ = progress.timings();
    return built;
  }

  BuildScope ScopeOf(const std::string& to, const std::string& from = "",
                     const std::string& work = "") const {
    BuildScope scope;
    scope.is_odometry_only = true;
    scope.products = root_ / to;
    if (!from.empty()) scope.from = root_ / from;
    if (!work.empty()) scope.work = root_ / work;
    return scope;
  }
  /// Whether the map's odometry is that of the ended build: one file.
  bool IsOdometryOfWork(const std::string& map) const {
    return std::filesystem::equivalent(root_ / map / "monday/odometry.bin",
                                       root_ / "work/monday/odometry.bin");
  }
  static void ExpectSamePath(const BuiltMap& a, const BuiltMap& b) {
    const auto& before = a.site.drives[0].site_from_body_trajectory.states();
    const auto& after = b.site.drives[0].site_from_body_trajectory.states();
    ASSERT_EQ(before.size(), after.size());
    for (size_t i = 0; i < before.size(); ++i)
      ASSERT_EQ(before[i].world_from_body.Matrix(), after[i].world_from_body.Matrix());
  }

  const std::filesystem::path root_ = std::filesystem::path(testing::TempDir()) / "build_map_test";
  const MapOptions options_;
  std::vector<StageTiming> timings_;
};

TEST_F(BuildMapTest, ADriveInMemoryBecomesATrajectoryNearTheTruth) {
  Drives drives;
  drives.push_back(DriveThroughHall("monday", kDuration));

  const BuiltMap built = Build(drives, "map");

  ASSERT_EQ(built.site.drives.size(), 1u);
  const Trajectory& site_from_body = built.site.drives[0].site_from_body_trajectory;
  const MotionFunction truth = CarMotion(kDuration);
  const Rigid3 site_from_world =
      *site_from_body.At(site_from_body.span().begin) * truth(0).world_from_body.Inverse();
  const double end = site_from_body.span().Seconds();
  const Eigen::Vector3d expected = site_from_world * truth(end).world_from_body.translation;
  EXPECT_GT((truth(end).world_from_body.translation - truth(0).world_from_body.translation).norm(),
            3);
  EXPECT_LT((site_from_body.At(site_from_body.span().end)->translation - expected).norm(), 0.1);
  std::vector<std::string> stages;
  for (const StageTiming& timing : timings_) stages.push_back(timing.name);
  EXPECT_EQ(stages, (std::vector<std::string>{"track", "close loops", "refine", "join drives"}));
}

TEST_F(BuildMapTest, ABuildFromAMapTakesItsStagesAndGivesTheSame) {
  Drives drives;
  drives.push_back(DriveThroughHall("monday", kDuration));
  const BuiltMap first = Build(drives, "first");
  WriteReport(first, drives, options_, {{"monday", {}}}, timings_, root_ / "first/report.json");

  const BuiltMap again = Build(drives, "again", "first");

  EXPECT_GT(first.drives[0].odometry.seconds, 0);
  EXPECT_EQ(again.drives[0].loops.seconds, 0) << "taken";
  EXPECT_EQ(again.drives[0].refinement.seconds, 0) << "taken";
  ExpectSamePath(first, again);
}

TEST_F(BuildMapTest, ABuildThatWasEndedIsTakenUpWhereItWas) {
  Drives drives;
  drives.push_back(DriveThroughHall("monday", kDuration));
  const BuiltMap first = Build(drives, "first", "", "work");
  std::filesystem::remove_all(root_ / "first");  // as of an attempt that ended without a map

  const BuiltMap again = Build(drives, "again", "", "work");

  EXPECT_TRUE(IsOdometryOfWork("again"));
  EXPECT_EQ(again.drives[0].loops.seconds, 0) << "taken";
  EXPECT_EQ(again.drives[0].refinement.seconds, 0) << "taken";
  ExpectSamePath(first, again);
  MapOptions other = options_;
  other.odometry.use_wheels = !other.odometry.use_wheels;
  Progress progress(PlanStages(1, true), {});
  const auto before = std::filesystem::last_write_time(root_ / "work/monday/odometry.bin");
  BuildMap(drives, other, ScopeOf("changed", "", "work"), progress);
  EXPECT_NE(std::filesystem::last_write_time(root_ / "work/monday/odometry.bin"), before)
      << "of other options nothing is taken";
}

TEST_F(BuildMapTest, APreparedDriveIsNotWorkedOnAgain) {
  Drives drives;
  drives.push_back(DriveThroughHall("monday", kDuration));
  Progress progress(PlanPreparation(), {});
  PrepareDrive(drives[0], options_, ScopeOf("preparation", "", "work"), progress);
  std::filesystem::remove_all(root_ / "preparation");
  const std::set<std::string> kept = ContentOf(root_ / "work" / "monday");
  for (const char* file : {"odometry.bin", "agreement.bin", "loops.bin", "refinement.bin",
                           "residuals.bin", "places.bin", "words.bin", "ground.bin", "heights.bin"})
    EXPECT_TRUE(kept.contains(file)) << file;

  const BuiltMap prepared = Build(drives, "prepared", "", "work");

  EXPECT_TRUE(IsOdometryOfWork("prepared"));
  EXPECT_EQ(prepared.drives[0].refinement.seconds, 0) << "taken";
  ExpectSamePath(prepared, Build(drives, "plain"));
}

TEST_F(BuildMapTest, GroundAndHeightsOutlastARefinementThatMovesNothing) {
  Drives drives;
  drives.push_back(DriveThroughHall("monday", kDuration));
  Progress progress(PlanPreparation(), {}), again(PlanPreparation(), {});
  PrepareDrive(drives[0], options_, ScopeOf("first", "", "work"), progress);
  MapOptions other = options_;
  other.gnss.max_fix_sigma /= 2;  // the drive has no fixes, but is refined again

  PrepareDrive(drives[0], other, ScopeOf("second", "", "work"), again);

  const auto is_shared = [&](const std::string& file) {
    return std::filesystem::equivalent(root_ / "first/monday" / file,
                                       root_ / "second/monday" / file);
  };
  EXPECT_FALSE(is_shared("refinement.bin"));
  EXPECT_TRUE(is_shared("ground.bin"));
  EXPECT_TRUE(is_shared("heights.bin"));
}

TEST_F(BuildMapTest, ADriveThatCannotBeTrackedIsLeftOutWithAWarning) {
  Drives drives;
  drives.push_back(DriveThroughHall("monday", kDuration));
  drives.push_back(DriveWithoutImages("blind", 3));

  const BuiltMap built = Build(drives, "map");

  ASSERT_EQ(built.site.drives.size(), 1u);
  EXPECT_EQ(built.site.drives[0].name, "monday");
  ASSERT_EQ(built.left_out.size(), 1u);
  EXPECT_EQ(built.left_out[0].name, "blind");
  ASSERT_FALSE(built.warnings.empty());
  EXPECT_NE(built.warnings[0].find("'blind' is left out"), std::string::npos);
}

TEST_F(BuildMapTest, WithoutAnyDriveThatCanBeTrackedThereIsNoMap) {
  Drives drives;
  drives.push_back(DriveWithoutImages("blind", 3));
  drives.push_back(DriveWithoutImages("dark", 3));

  try {
    Build(drives, "map");
    FAIL() << "there was nothing to map";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
  }
}

}  // namespace
}  // namespace parkade
