#include <set>

#include "core/trajectory.h"
#include "server/ingest/inspection/inspect_log.h"
#include "tests/simulator/drives/drive_summary.h"
#include "tests/support/simulated_drive.h"

namespace parkade::simulator {
namespace {

namespace fs = std::filesystem;

/// Faults where they are asked for, and nowhere else.
class DriveFaults : public SimulatedDrive {};

TEST_F(DriveFaults, TheSummaryTellsOptionsHashAndFaults) {
  SimulateOptions options = SmallDrive();
  options.faults.imu_gap = {4, 4.5};
  options.faults.slip = {5, 6, 0.5};
  options.faults.occlusion = {1, 2, 4, "mud"};
  const nlohmann::json summary = Simulate("faulty.mcap", options);

  EXPECT_EQ(nlohmann::json::parse(ReadFile(root_ / "faulty.truth" / "summary.json")), summary);
  EXPECT_EQ(summary["options_hash"], HashOf(options));
  EXPECT_NE(summary["options_hash"], Made("euroc")["options_hash"]);
  EXPECT_EQ(summary["faults"]["records_concerned"]["gap.imu"], 50);
  EXPECT_EQ(summary["faults"]["records_concerned"]["slip.wheels"], 100);
  EXPECT_NEAR(summary["faults"]["records_concerned"]["occlusion.cam1"].get<int>(), 4, 1);
  EXPECT_TRUE(summary["faults"]["asked_for"].contains("imu_gap"));
  EXPECT_TRUE(Made("euroc")["faults"]["asked_for"].empty());
}

/// Names of the files below a EuRoC folder that differ, without the name of the file itself where
/// folders hold many.
std::set<std::string> DifferentFolders(std::map<std::string, std::string> a,
                                       std::map<std::string, std::string> b) {
  std::set<std::string> folders;
  for (const auto* one : {&a, &b}) {
    const auto& other = one == &a ? b : a;
    for (const auto& [name, content] : *one) {
      const auto found = other.find(name);
      if (found == other.end() || found->second != content)
        folders.insert(fs::path(name).parent_path());
    }
  }
  folders.erase("");  // summary.json tells what was asked for
  return folders;
}

TEST_F(DriveFaults, AFaultOfALensIsInTheImagesOfItsCameraAndNowhereElse) {
  SimulateOptions options = SmallDrive();
  options.faults.occlusion = {2, 3, 6, "dark"};
  Simulate("covered", options);

  EXPECT_EQ(DifferentFolders(Contents(PathOf("euroc")), Contents(root_ / "covered")),
            std::set<std::string>{"mav0/cam2/data"});
}

TEST_F(DriveFaults, AKnockedMirrorIsInTheImagesAfterItAndInTheTrueRig) {
  SimulateOptions options = SmallDrive();
  options.faults.mirror = {1, 5, 3};
  const nlohmann::json summary = Simulate("knocked", options);

  EXPECT_EQ(
      DifferentFolders(Contents(PathOf("euroc")), Contents(root_ / "knocked")),
      (std::set<std::string>{"mav0/cam1/data", "mav0/cam1/semantic/data", "rig_true_knocked"}));
  EXPECT_NEAR(summary["faults"]["records_concerned"]["mirror.cam1"].get<int>(), 10, 2);
  const Rig before = ReadRig(root_ / "knocked" / "rig_true"),
            after = ReadRig(root_ / "knocked" / "rig_true_knocked");
  const Eigen::Quaterniond turn = before.cameras[1].body_from_camera.rotation.conjugate() *
                                  after.cameras[1].body_from_camera.rotation;
  EXPECT_NEAR(LogSo3(turn).norm() * 180 / M_PI, 3, 1e-6);
}

TEST_F(DriveFaults, AWrongCalibrationIsWhereCalibrationsAreAndNotInTheImages) {
  SimulateOptions options = SmallDrive();
  options.faults.extrinsic_rotation_deg = {0, 0, 1, 0};
  Simulate("wrong_rig", options);

  EXPECT_EQ(DifferentFolders(Contents(PathOf("euroc")), Contents(root_ / "wrong_rig")),
            (std::set<std::string>{"mav0/cam2", "rig"}));  // sensor.yaml
}

TEST_F(DriveFaults, SlippingWheelsAreInTheOdometryAlone) {
  SimulateOptions options = SmallDrive();
  options.faults.slip = {3, 6, 0.5};
  Simulate("slip", options);

  EXPECT_EQ(DifferentFolders(Contents(PathOf("euroc")), Contents(root_ / "slip")),
            std::set<std::string>{"mav0/odom0"});
}

TEST_F(DriveFaults, InspectNamesGapsJumpsAndDamage) {
  SimulateOptions options = SmallDrive();
  options.faults.imu_gap = {4, 4.5};
  options.faults.time_jump = {"wheels", 6, 6.5, -0.2};
  options.faults.corrupt_jpegs = 0.2;
  options.faults.duplicates = 0.02;
  const nlohmann::json summary = Simulate("inspected.mcap", options);

  const LogInspection inspection =
      InspectLog(root_ / "inspected.mcap", root_ / "inspected.truth" / "rig");
  EXPECT_EQ(inspection.state, LogState::kLossy);
  std::uint64_t num_damaged = 0, num_repeated = 0;
  for (const TopicInspection& topic : inspection.topics) {
    num_damaged += topic.num_undecodable;
    num_repeated += topic.num_repeated;
    if (topic.topic == "/imu/data") {
      ASSERT_EQ(topic.gaps.size(), 1u);
      EXPECT_NEAR(topic.gaps[0].seconds, 0.51, 0.02);
    }
    if (topic.topic == "/vehicle/odometry") {
      EXPECT_GE(topic.num_backward, 1u);
      EXPECT_NEAR(topic.largest_backward_jump, 0.2, 0.02);
    }
  }
  EXPECT_GE(num_damaged + 3,
            summary["faults"]["records_concerned"]["corrupt_jpegs"].get<std::uint64_t>());
  EXPECT_GT(num_damaged, 5u);
  EXPECT_GT(num_repeated, 20u);
}

TEST_F(DriveFaults, InspectNamesDarkAndCoveredCameras) {
  SimulateOptions options = SmallDrive();
  options.duration = 16;
  options.ground_texel = 0.03;
  options.rig.width = 320;
  options.rig.height = 200;
  options.faults.darkness = {11, 13};
  options.faults.occlusion = {3, 3, 10, "mud"};
  Simulate("covered.mcap", options);

  const LogInspection inspection =
      InspectLog(root_ / "covered.mcap", root_ / "covered.truth" / "rig");
  EXPECT_EQ(inspection.state, LogState::kClean)
      << "images that are dark were recorded as they were";
  for (const TopicInspection& topic : inspection.topics) {
    if (!topic.topic.ends_with("/compressed")) {
      EXPECT_TRUE(topic.image_faults.empty()) << topic.topic;
      continue;
    }
    const bool is_rear = topic.topic.starts_with("/cam3");
    ASSERT_EQ(topic.image_faults.size(), is_rear ? 2u : 1u) << topic.topic;
    const CameraFault& dark = topic.image_faults[0];
    EXPECT_EQ(dark.kind, CameraFault::Kind::kDark);
    EXPECT_NEAR(dark.begin - inspection.span.begin, 11, 0.7);
    EXPECT_NEAR(dark.end - inspection.span.begin, 13, 0.7);
    if (!is_rear) continue;
    const CameraFault& mud = topic.image_faults[1];
    EXPECT_EQ(mud.kind, CameraFault::Kind::kCovered);
    EXPECT_NEAR(mud.begin - inspection.span.begin, 3, 1.5);
    EXPECT_NEAR(mud.end - inspection.span.begin, 10, 1.5);
  }
}

}  // namespace
}  // namespace parkade::simulator
