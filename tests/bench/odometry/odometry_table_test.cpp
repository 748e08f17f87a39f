#include "tests/bench/odometry/odometry_table.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "tests/bench/odometry/odometry_table_report.h"

namespace parkade {
namespace {

TableRun MakeRun(const std::string& drive, const std::string& scene, const std::string& variant,
                 double drift) {
  TableRun run;
  run.drive = drive;
  run.scene = scene;
  run.variant = variant;
  run.drift_percent = drift;
  run.duration = 10;
  return run;
}

SuiteDrive MakeDrive() {
  SuiteDrive drive;
  drive.name = "somewhere";
  for (const char* name : {"cam0", "cam1"}) {
    RigCamera camera;
    camera.name = name;
    camera.time_shift = 0.004;
    drive.true_rig.cameras.push_back(camera);
  }
  return drive;
}

TEST(OdometryTable, AVariantSaysWhatItIs) {
  const TableVariant variant = ParseVariant("cam2-wheels-0.3");

  EXPECT_EQ(variant.camera, "cam2");
  EXPECT_TRUE(variant.has_wheels);
  EXPECT_NEAR(variant.rotation_deg, 0.3, 1e-12);
  EXPECT_NEAR(variant.translation_cm, 1, 1e-12);
  EXPECT_TRUE(ParseVariant("four-exact").camera.empty());
  EXPECT_NEAR(ParseVariant("four-1").translation_cm, 3, 1e-12);
  for (const char* nonsense : {"four", "four-", "four-wheel-exact", "four-wrong"})
    EXPECT_THROW(ParseVariant(nonsense), Error) << nonsense;
}

TEST(OdometryTable, EveryCameraOfARigIsOffByWhatIsAsked) {
  const SuiteDrive drive = MakeDrive();

  const Rig off = RigOfVariant(ParseVariant("four-1"), drive);

  for (size_t camera = 0; camera < 2; ++camera) {
    const Rigid3 error = drive.true_rig.cameras[camera].body_from_camera.Inverse() *
                         off.cameras[camera].body_from_camera;
    EXPECT_NEAR(LogSo3(error.rotation).norm(), M_PI / 180, 1e-9);
    EXPECT_NEAR(error.translation.norm(), 0.03, 1e-9);
  }
  EXPECT_EQ(RigOfVariant(ParseVariant("four-exact"), drive).cameras[0].time_shift, 0.004);
  EXPECT_NEAR(RigOfVariant(ParseVariant("four-stamps"), drive).cameras[1].time_shift, 0.004 - 0.03,
              1e-12);
}

TEST(OdometryTable, FourCamerasAreComparedWithTheBestSingleOne) {
  const std::vector<TableRun> runs{
      MakeRun("a", "lot", "four-exact", 0.2), MakeRun("a", "lot", "cam0-exact", 0.1),
      MakeRun("a", "lot", "cam1-exact", 0.4), MakeRun("b", "garage", "four-exact", 0.1),
      MakeRun("b", "garage", "cam0-exact", 0.2)};

  const std::string text = ToMarkdown(runs);

  EXPECT_NE(text.find("| exact | 2 | 1.25 / 1.25 / 2.00 | a 0.200/0.100 |"), std::string::npos)
      << text;
  EXPECT_NE(text.find("| four-exact | garages | 1 | 0.100 / 0.100 / 0.100 |"), std::string::npos)
      << text;
}

TEST(OdometryTable, RunsComeBackFromTheirFile) {
  TableRun run = MakeRun("a", "lot", "four-exact", 6);
  run.degraded = {"1.0-2.0 s: dark"};

  const TableRun again = TableRunFromJson(ToJson(run));

  EXPECT_EQ(ToJson(again), ToJson(run));
  EXPECT_TRUE(IsFailure(again));
}

}  // namespace
}  // namespace parkade
