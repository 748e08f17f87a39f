#include "tests/simulator/simulate_drive.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/error.h"
#include "core/file.h"
#include "core/trajectory.h"
#include "server/ingest/inspect_log.h"
#include "server/ingest/open_drive_log.h"
#include "tests/simulator/drive_summary.h"

namespace parkade::simulator {
namespace {

namespace fs = std::filesystem;

SimulateOptions SmallDrive() {
  SimulateOptions options;
  options.duration = 10;
  options.ground_texel = 0.1;
  options.cameras.rate = 2;
  options.rig.width = 160;
  options.rig.height = 100;
  options.semantic = true;
  return options;
}

/// One drive in each format, made when a test asks for it.
class SimulatedDrive : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = fs::path(testing::TempDir()) / ("parkade_simulate_" + std::to_string(getpid()));
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  static void TearDownTestSuite() { fs::remove_all(root_); }

  static nlohmann::json Simulate(const fs::path& log, const SimulateOptions& options) {
    return SimulateDrive(options, {root_ / log, {}, {}}, [](const std::string&, double) {});
  }

  static constexpr const char* kFormats[] = {"euroc", "ros2.mcap", "ros1.bag"};

  /// Summary of the small drive in one of the formats.
  static const nlohmann::json& Made(const std::string& name) {
    if (!summaries_.contains(name)) summaries_[name] = Simulate(name, SmallDrive());
    return summaries_[name];
  }
  /// Its folder or file.
  static fs::path PathOf(const std::string& name) {
    Made(name);
    return root_ / name;
  }

  static std::unique_ptr<RecordedDrive> Open(const std::string& name) {
    return OpenDriveLog(root_ / name, {.rig_folder = DefaultTruthFolder(root_ / name) / "rig"});
  }

  /// Content of every file below `folder`, by relative name.
  static std::map<std::string, std::string> Contents(const fs::path& folder) {
    std::map<std::string, std::string> contents;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file()) contents[fs::relative(entry.path(), folder)] = ReadFile(entry.path());
    return contents;
  }

  static inline fs::path root_;
  static inline std::map<std::string, nlohmann::json> summaries_;
};

/// Counts per kind of what a reader gives, and checks that time never runs back.
std::map<std::string, size_t> CountRecords(const DriveLog& log) {
  ReadOptions options;
  options.semantics = true;
  std::map<std::string, size_t> counts;
  Timestamp last{0};
  const auto stream = log.Read(options);
  while (const auto record = stream->Next()) {
    EXPECT_GE(TimeOf(*record), last);
    last = TimeOf(*record);
    static const char* const kNames[] = {"imu", "wheels", "gnss", "images", "masks"};
    ++counts[kNames[record->index()]];
  }
  return counts;
}

TEST_F(SimulatedDrive, EveryFormatReadsBackWhole) {
  for (const std::string name : kFormats) {
    const nlohmann::json& summary = Made(name);
    const auto log = Open(name);

    const auto counts = CountRecords(*log);
    EXPECT_EQ(counts.at("images"), summary["counts"]["images"]) << name;
    EXPECT_EQ(counts.at("masks"), summary["counts"]["images"]) << name;
    EXPECT_EQ(counts.at("imu"), 1000u) << name;
    EXPECT_EQ(counts.at("wheels"), 1000u) << name;
    EXPECT_EQ(counts.at("gnss"), summary["counts"]["gnss"]) << name;
    ASSERT_EQ(log->rig().cameras.size(), 4u) << name;
    EXPECT_FALSE(log->rig().cameras[0].mask.empty()) << name;
  }
}

TEST_F(SimulatedDrive, AllFormatsHoldTheSameNumbers) {
  std::map<std::string, std::vector<ImuSample>> samples;
  std::map<std::string, std::vector<GnssFix>> fixes;
  for (const std::string name : kFormats) {
    Made(name);
    const auto log = Open(name);
    const auto stream = log->Read({});
    while (const auto record = stream->Next()) {
      if (const auto* imu = std::get_if<ImuSample>(&*record)) samples[name].push_back(*imu);
      if (const auto* fix = std::get_if<GnssFix>(&*record)) fixes[name].push_back(*fix);
    }
  }
  for (size_t i = 0; i < samples["euroc"].size(); ++i) {
    const ImuSample &euroc = samples["euroc"][i], &ros1 = samples["ros1.bag"][i], &ros2 = samples["ros2.mcap"][i];
    EXPECT_EQ(euroc.time, ros2.time);
    EXPECT_EQ(ros1.time, ros2.time);
    EXPECT_EQ(ros1.linear_acceleration, ros2.linear_acceleration);
    EXPECT_EQ(ros1.angular_velocity, ros2.angular_velocity);
    EXPECT_LT((euroc.linear_acceleration - ros2.linear_acceleration).norm(), 1e-9);
  }
  for (size_t i = 0; i < fixes["euroc"].size(); ++i) {
    EXPECT_EQ(fixes["ros1.bag"][i].latitude_deg, fixes["ros2.mcap"][i].latitude_deg);
    EXPECT_NEAR(fixes["euroc"][i].longitude_deg, fixes["ros2.mcap"][i].longitude_deg, 1e-10);
    EXPECT_LT((fixes["ros1.bag"][i].sigma_enu - fixes["euroc"][i].sigma_enu).norm(), 1e-4);
  }
}

TEST_F(SimulatedDrive, TheSameOptionsGiveTheSameBytes) {
  for (const std::string name : {"euroc", "ros2.mcap"}) Simulate("again_" + name, SmallDrive());

  EXPECT_EQ(ReadFile(PathOf("ros2.mcap")), ReadFile(root_ / "again_ros2.mcap"));
  auto first = Contents(PathOf("euroc")), second = Contents(root_ / "again_euroc");
  first.erase("summary.json");
  second.erase("summary.json");
  EXPECT_EQ(first, second);
  EXPECT_GT(first.size(), 80u);
}

TEST_F(SimulatedDrive, AnotherSeedGivesAnotherDrive) {
  SimulateOptions options = SmallDrive();
  options.seed = 2;
  Simulate("other.bag", options);
  EXPECT_NE(ReadFile(PathOf("ros1.bag")), ReadFile(root_ / "other.bag"));
}

TEST_F(SimulatedDrive, SensorsThatWereSwitchedOffAreInNeitherLogNorRig) {
  SimulateOptions options = SmallDrive();
  options.sensors.gnss = "none";
  options.sensors.has_wheels = false;
  options.rig.num_cameras = 2;
  Simulate("few.mcap", options);

  const auto log = Open("few.mcap");
  const auto counts = CountRecords(*log);
  EXPECT_FALSE(counts.contains("gnss"));
  EXPECT_FALSE(counts.contains("wheels"));
  EXPECT_EQ(log->rig().cameras.size(), 2u);
  EXPECT_TRUE(log->rig().vehicle->gnss_topic.empty());
}

TEST_F(SimulatedDrive, TruthCoversEveryRecord) {
  const std::vector<TimedPose> truth = ReadTum(PathOf("euroc") / "truth.tum");
  const auto log = Open("euroc");

  EXPECT_LE(truth.front().time, log->span().begin);
  EXPECT_LT(log->span().end - truth.back().time, 0.005);
  EXPECT_EQ(ReadFile(PathOf("euroc") / "ground_truth.ply").substr(0, 4), "ply\n");
}

TEST_F(SimulatedDrive, TheSummaryTellsOptionsHashAndFaults) {
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

/// Names of the files below a EuRoC folder that differ, without the name of the file itself where folders hold many.
std::set<std::string> DifferentFolders(std::map<std::string, std::string> a, std::map<std::string, std::string> b) {
  std::set<std::string> folders;
  for (const auto* one : {&a, &b}) {
    const auto& other = one == &a ? b : a;
    for (const auto& [name, content] : *one) {
      const auto found = other.find(name);
      if (found == other.end() || found->second != content) folders.insert(fs::path(name).parent_path());
    }
  }
  folders.erase("");  // summary.json tells what was asked for
  return folders;
}

TEST_F(SimulatedDrive, AFaultOfALensIsInThePicturesOfItsCameraAndNowhereElse) {
  SimulateOptions options = SmallDrive();
  options.faults.occlusion = {2, 3, 6, "dark"};
  Simulate("covered", options);

  EXPECT_EQ(DifferentFolders(Contents(PathOf("euroc")), Contents(root_ / "covered")),
            std::set<std::string>{"mav0/cam2/data"});
}

TEST_F(SimulatedDrive, AKnockedMirrorIsInThePicturesAfterItAndInTheTrueRig) {
  SimulateOptions options = SmallDrive();
  options.faults.mirror = {1, 5, 3};
  const nlohmann::json summary = Simulate("knocked", options);

  EXPECT_EQ(DifferentFolders(Contents(PathOf("euroc")), Contents(root_ / "knocked")),
            (std::set<std::string>{"mav0/cam1/data", "mav0/cam1/semantic/data", "rig_true_knocked"}));
  EXPECT_NEAR(summary["faults"]["records_concerned"]["mirror.cam1"].get<int>(), 10, 2);
  const Rig before = ReadRig(root_ / "knocked" / "rig_true"), after = ReadRig(root_ / "knocked" / "rig_true_knocked");
  const Eigen::Quaterniond turn =
      before.cameras[1].body_from_camera.rotation.conjugate() * after.cameras[1].body_from_camera.rotation;
  EXPECT_NEAR(LogSo3(turn).norm() * 180 / M_PI, 3, 1e-6);
}

TEST_F(SimulatedDrive, AWrongCalibrationIsWhereCalibrationsAreAndNotInThePictures) {
  SimulateOptions options = SmallDrive();
  options.faults.extrinsic_rotation_deg = {0, 0, 1, 0};
  Simulate("wrong_rig", options);

  EXPECT_EQ(DifferentFolders(Contents(PathOf("euroc")), Contents(root_ / "wrong_rig")),
            (std::set<std::string>{"mav0/cam2", "rig"}));  // sensor.yaml
}

TEST_F(SimulatedDrive, SlippingWheelsAreInTheOdometryAlone) {
  SimulateOptions options = SmallDrive();
  options.faults.slip = {3, 6, 0.5};
  Simulate("slip", options);

  EXPECT_EQ(DifferentFolders(Contents(PathOf("euroc")), Contents(root_ / "slip")), std::set<std::string>{"mav0/odom0"});
}

TEST_F(SimulatedDrive, InspectNamesGapsJumpsAndDamage) {
  SimulateOptions options = SmallDrive();
  options.faults.imu_gap = {4, 4.5};
  options.faults.time_jump = {"wheels", 6, 6.5, -0.2};
  options.faults.corrupt_jpegs = 0.2;
  options.faults.duplicates = 0.02;
  const nlohmann::json summary = Simulate("inspected.mcap", options);

  const LogInspection inspection = InspectLog(root_ / "inspected.mcap", root_ / "inspected.truth" / "rig");
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
  EXPECT_GE(num_damaged + 3, summary["faults"]["records_concerned"]["corrupt_jpegs"].get<std::uint64_t>());
  EXPECT_GT(num_damaged, 5u);
  EXPECT_GT(num_repeated, 20u);
}

TEST_F(SimulatedDrive, SlotsAreWhereThePlaceHasThem) {
  const nlohmann::json slots = nlohmann::json::parse(ReadFile(PathOf("euroc") / "slots.geojson"));
  const Place place = PlanPlace("lot", SmallDrive().OfScene());

  ASSERT_EQ(slots["features"].size(), place.slots.size());
  for (size_t i = 0; i < place.slots.size(); ++i) {
    const auto ring = slots["features"][i]["geometry"]["coordinates"][0];
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int corner = 0; corner < 4; ++corner)
      middle += 0.25 * SiteFromGeodetic(SimulatedDatum(), ring[corner][1], ring[corner][0], ring[corner][2]);
    EXPECT_LT((middle.head<2>() - place.slots[i].outline.center).norm(), 1e-3);
    EXPECT_EQ(slots["features"][i]["properties"]["is_occupied"], place.slots[i].is_occupied);
  }
}

TEST_F(SimulatedDrive, AnExistingLogIsNotOverwritten) {
  WriteFileAtomically(root_ / "mine.bag", "precious");
  EXPECT_THROW(Simulate("mine.bag", SmallDrive()), Error);
  EXPECT_EQ(ReadFile(root_ / "mine.bag"), "precious");
}

TEST(SimulateOptions, NonsenseIsRefused) {
  SimulateOptions options;
  options.duration = 2;
  EXPECT_THROW(options.Validate(), Error);
  options = {};
  options.scene = "moon";
  EXPECT_THROW(SimulateDrive(options, {"unused", {}, {}}, [](const std::string&, double) {}), Error);
}

}  // namespace
}  // namespace parkade::simulator
