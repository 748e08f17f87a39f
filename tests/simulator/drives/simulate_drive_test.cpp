#include "tests/simulator/drives/simulate_drive.h"

#include "core/error.h"
#include "core/trajectory.h"
#include "tests/simulator/layouts/plan_place.h"
#include "tests/simulator/scenes/build_scene.h"
#include "tests/support/simulated_drive.h"

namespace parkade::simulator {
namespace {

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
  ASSERT_FALSE(samples["euroc"].empty());
  ASSERT_FALSE(fixes["euroc"].empty());
  for (const std::string name : kFormats) {
    ASSERT_EQ(samples[name].size(), samples["euroc"].size()) << name;
    ASSERT_EQ(fixes[name].size(), fixes["euroc"].size()) << name;
  }
  for (size_t i = 0; i < samples["euroc"].size(); ++i) {
    const ImuSample &euroc = samples["euroc"][i], &ros1 = samples["ros1.bag"][i],
                    &ros2 = samples["ros2.mcap"][i];
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

TEST_F(SimulatedDrive, AnotherLensIsInTheImagesAndInTheRig) {
  SimulateOptions options = SmallDrive();
  options.rig.lens = "ds";
  Simulate("lens.mcap", options);

  const auto log = Open("lens.mcap");
  for (const RigCamera& camera : log->rig().cameras)
    EXPECT_TRUE(std::holds_alternative<DoubleSphereProjection>(camera.model.projection()))
        << camera.name;
  EXPECT_NE(ReadFile(root_ / "lens.mcap"), ReadFile(PathOf("ros2.mcap")));
  EXPECT_THROW(Simulate("lens", options), Error) << "EuRoC folders know no such lens";
  EXPECT_FALSE(std::filesystem::exists(root_ / "lens"));
}

TEST_F(SimulatedDrive, TruthCoversEveryRecord) {
  const std::vector<TimedPose> truth = ReadTum(PathOf("euroc") / "truth.tum");
  const auto log = Open("euroc");

  EXPECT_LE(truth.front().time, log->span().begin);
  EXPECT_LT(log->span().end - truth.back().time, 0.005);
  EXPECT_EQ(ReadFile(PathOf("euroc") / "ground_truth.ply").substr(0, 4), "ply\n");
}

TEST_F(SimulatedDrive, SlotsAreWhereThePlaceHasThem) {
  const nlohmann::json slots = nlohmann::json::parse(ReadFile(PathOf("euroc") / "slots.geojson"));
  const Place place = PlanPlace("lot", SmallDrive().OfScene());

  ASSERT_EQ(slots["features"].size(), place.slots.size());
  for (size_t i = 0; i < place.slots.size(); ++i) {
    const auto ring = slots["features"][i]["geometry"]["coordinates"][0];
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int corner = 0; corner < 4; ++corner)
      middle += 0.25 * SiteFromGeodetic(SimulatedDatum(), ring[corner][1], ring[corner][0],
                                        ring[corner][2]);
    EXPECT_LT((middle.head<2>() - place.slots[i].outline.center).norm(), 1e-3);
    EXPECT_EQ(slots["features"][i]["properties"]["is_occupied"], place.slots[i].is_occupied);
  }
}

TEST_F(SimulatedDrive, KerbsAreWhereTheSceneHasThem) {
  const nlohmann::json kerbs = nlohmann::json::parse(ReadFile(PathOf("euroc") / "kerbs.geojson"));
  const Scene scene = BuildScene("lot", SmallDrive().OfScene());

  ASSERT_EQ(kerbs["features"].size(), scene.kerbs.size());
  for (size_t i = 0; i < scene.kerbs.size(); ++i) {
    const auto line = kerbs["features"][i]["geometry"]["coordinates"];
    const Eigen::Vector3d begin =
        SiteFromGeodetic(SimulatedDatum(), line[0][1], line[0][0], line[0][2]);
    EXPECT_LT((begin - scene.kerbs[i].begin).norm(), 1e-3);
    EXPECT_EQ(kerbs["features"][i]["properties"]["height_m"], scene.kerbs[i].height);
    EXPECT_EQ(kerbs["features"][i]["properties"]["type"], "kerb");
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
  EXPECT_THROW(SimulateDrive(options, {"unused", {}, {}}, [](const std::string&, double) {}),
               Error);
}

}  // namespace
}  // namespace parkade::simulator
