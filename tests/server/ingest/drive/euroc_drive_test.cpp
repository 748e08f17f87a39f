#include <gtest/gtest.h>

#include <regex>

#include "core/error.h"
#include "server/ingest/drive/open_drive_log.h"
#include "tests/server/ingest/drive/euroc_folder.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

std::vector<SensorRecord> ReadAll(const DriveLog& log, const ReadOptions& options = {}) {
  std::vector<SensorRecord> records;
  const auto stream = log.Read(options);
  while (auto record = stream->Next()) records.push_back(std::move(*record));
  return records;
}

template <typename T>
std::vector<T> Select(const std::vector<SensorRecord>& records) {
  std::vector<T> selected;
  for (const SensorRecord& record : records)
    if (const T* found = std::get_if<T>(&record)) selected.push_back(*found);
  return selected;
}

void ExpectOrdered(const std::vector<SensorRecord>& records) {
  for (std::size_t i = 1; i < records.size(); ++i)
    ASSERT_LE(TimeOf(records[i - 1]), TimeOf(records[i])) << i;
}

std::string WhatOpeningThrows(const fs::path& log, const OpenLogOptions& options = {}) {
  try {
    OpenDriveLog(log, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing";
}

/// Replaces a text in a file once.
void Edit(const fs::path& file, const std::string& from, const std::string& to) {
  std::ifstream stream(file);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  WriteText(file, text.replace(at, from.size(), to));
}

TEST(EurocDrive, DeliversEveryRecordInOrderOfTime) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "mav0", {.has_wheels = true, .has_gnss = true});

  const auto log = OpenDriveLog(folder.path());
  const std::vector<SensorRecord> records = ReadAll(*log);

  ExpectOrdered(records);
  const auto imu = Select<ImuSample>(records);
  ASSERT_EQ(imu.size(), 201u);
  EXPECT_EQ(imu[7].time.ns, 1'000'070'000'000);
  EXPECT_EQ(imu[7].angular_velocity, Eigen::Vector3d(0.01, 0.02, 0.03));
  EXPECT_NEAR(imu[7].linear_acceleration.z(), 9.807, 1e-9);
  const auto wheels = Select<WheelSample>(records);
  ASSERT_EQ(wheels.size(), 101u);
  EXPECT_EQ(wheels[0].forward_speed, 1.5);
  EXPECT_EQ(wheels[0].yaw_rate, 0.25);
  const auto fixes = Select<GnssFix>(records);
  ASSERT_EQ(fixes.size(), 3u);
  EXPECT_EQ(fixes[1].latitude_deg, 48.1);
  EXPECT_EQ(fixes[1].sigma_enu, Eigen::Vector3d(0.5, 0.6, 1.5));
  EXPECT_EQ(Select<CameraFrame>(records).size(), 42u);
  EXPECT_EQ(log->span().begin.ns, 1'000'000'000'000);
  EXPECT_EQ(log->span().end.ns, 1'002'007'000'000);
}

TEST(EurocDrive, EachFrameIsTheImageOfItsStamp) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "mav0");

  const auto frames = Select<CameraFrame>(ReadAll(*OpenDriveLog(folder.path())));

  std::array<int, 2> next{};
  for (const CameraFrame& frame : frames) {
    const int index = next[static_cast<std::size_t>(frame.camera)]++;
    EXPECT_EQ(frame.time.ns,
              1'000'000'000'000 + index * 100'000'000LL + frame.camera * 7'000'000LL);
    EXPECT_EQ(cv::norm(frame.image, NumberedImage(frame.camera, index), cv::NORM_INF), 0);
  }
  EXPECT_EQ(next[0], 21);
  EXPECT_EQ(next[1], 21);
}

TEST(EurocDrive, IsFoundFromTheFolderItsParentAndMav0Itself) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "my drive" / "mav0", {.num_cameras = 1});

  EXPECT_EQ(OpenDriveLog(folder.path())->rig().cameras.size(), 1u);
  EXPECT_EQ(OpenDriveLog(folder.path() / "my drive")->name(), "my_drive");
  EXPECT_EQ(OpenDriveLog(folder.path() / "my drive" / "mav0")->name(), "my_drive");
}

TEST(EurocDrive, TwoDrivesInOneFolderAreRefused) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "a" / "mav0", {.num_cameras = 1});
  WriteEurocFolder(folder.path() / "b" / "mav0", {.num_cameras = 1});

  EXPECT_NE(WhatOpeningThrows(folder.path()).find("several EuRoC drives"), std::string::npos);
}

TEST(EurocDrive, ItsRigComesFromSensorYaml) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "mav0");

  const auto log = OpenDriveLog(folder.path());

  const Rig& rig = log->rig();
  ASSERT_EQ(rig.cameras.size(), 2u);
  EXPECT_FALSE(rig.vehicle.has_value());
  EXPECT_EQ(rig.imu.gyroscope_noise_density, 2e-4);
  EXPECT_TRUE(rig.cameras[1].body_from_camera.translation.isApprox(Eigen::Vector3d(1.5, 0.5, 0.8)));
  // The optical axis points along the body's x.
  EXPECT_TRUE((rig.cameras[0].body_from_camera.rotation * Eigen::Vector3d::UnitZ())
                  .isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_EQ(rig.cameras[0].model.width(), 64);
}

TEST(EurocDrive, AWantsImageFilterSparesTheDecoding) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "mav0");
  // An image that cannot be decoded is no loss where it is not wanted.
  WriteText(folder.path() / "mav0" / "cam1" / "data" / "1000107000000.png", "no image");
  const auto log = OpenDriveLog(folder.path());

  const auto records = ReadAll(*log, {.imu = false, .wants_image = [](int camera, Timestamp time) {
                                        return camera == 0 && time.ns >= 1'001'000'000'000;
                                      }});

  EXPECT_EQ(records.size(), 11u);
  EXPECT_EQ(Select<CameraFrame>(records).size(), 11u);
  EXPECT_EQ(log->health().streams[2].NumDropped(), 0u);
}

TEST(EurocDrive, DamagedImagesAndLinesAreCountedAndSkipped) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "mav0", {.num_cameras = 1});
  const fs::path mav0 = folder.path() / "mav0";
  WriteText(mav0 / "cam0" / "data" / "1000300000000.png", "no image");
  fs::remove(mav0 / "cam0" / "data" / "1000400000000.png");
  cv::imwrite((mav0 / "cam0" / "data" / "1000500000000.png").string(),
              cv::Mat(24, 32, CV_8UC1, cv::Scalar(9)));
  Edit(mav0 / "imu0" / "data.csv", "1000100000000,0.01", "1000100000000,nan");
  Edit(mav0 / "imu0" / "data.csv", "1000110000000,", "1000100000000,");
  Edit(mav0 / "imu0" / "data.csv", "1000120000000,", "999000000000,");
  Edit(mav0 / "imu0" / "data.csv", "1000130000000,", "0,");
  Edit(mav0 / "imu0" / "data.csv", "1000140000000,", "banana,");
  Edit(mav0 / "imu0" / "data.csv", "1000150000000,0.01,0.02", "1000150000000,0.01");
  const auto log = OpenDriveLog(folder.path());
  EXPECT_TRUE(log->health().Warnings().empty()) << "no image was decoded yet";

  const auto records = ReadAll(*log);

  ExpectOrdered(records);
  EXPECT_EQ(Select<CameraFrame>(records).size(), 18u);
  EXPECT_EQ(Select<ImuSample>(records).size(),
            196u);  // 1.100 (once repeated), .12, .13, .14, .15 are gone
  const DriveLogHealth health = log->health();
  const StreamHealth& imu = health.streams[0];
  EXPECT_EQ(imu.num_delivered, 196u);
  EXPECT_EQ(imu.Dropped(DropReason::kNotFinite), 1u);
  EXPECT_EQ(imu.Dropped(DropReason::kBackwardStamp), 2u);
  EXPECT_EQ(imu.Dropped(DropReason::kDamaged), 1u);
  EXPECT_EQ(health.damage.num_lost_messages, 1u);
  const StreamHealth& camera = health.streams[1];
  EXPECT_EQ(camera.num_delivered, 18u);
  EXPECT_EQ(camera.Dropped(DropReason::kDamaged), 2u);
  EXPECT_EQ(camera.Dropped(DropReason::kWrongSize), 1u);
  ASSERT_EQ(health.Warnings().size(), 1u);
  EXPECT_NE(health.Warnings()[0].find("loses 3 of 21 messages"), std::string::npos);
}

TEST(EurocDrive, AStampFarAheadDoesNotHoldUpTheRest) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "mav0");
  Edit(folder.path() / "mav0" / "cam0" / "data.csv", "1000500000000,", "4600500000000,");
  Edit(folder.path() / "mav0" / "imu0" / "data.csv", "1000700000000,", "4600700000000,");
  const auto log = OpenDriveLog(folder.path());

  const auto records = ReadAll(*log);

  ExpectOrdered(records);
  EXPECT_EQ(Select<CameraFrame>(records).size(), 41u);
  EXPECT_EQ(Select<ImuSample>(records).size(), 200u);
  EXPECT_EQ(log->span().end.ns, 1'002'007'000'000);
  EXPECT_EQ(log->health().streams[0].Dropped(DropReason::kOffClock), 1u);
  EXPECT_EQ(log->health().streams[1].Dropped(DropReason::kOffClock), 1u);
}

TEST(EurocDrive, ChosenCamerasAreDeliveredInTheOrderNamed) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "mav0", {.num_cameras = 3});

  const auto log = OpenDriveLog(folder.path(), {.cameras = {"cam2", "cam0"}});

  ASSERT_EQ(log->rig().cameras.size(), 2u);
  EXPECT_EQ(log->rig().cameras[0].name, "cam2");
  for (const CameraFrame& frame : Select<CameraFrame>(ReadAll(*log)))
    EXPECT_EQ(frame.time.ns % 100'000'000 / 7'000'000, frame.camera == 0 ? 2 : 0);
  EXPECT_EQ(WhatOpeningThrows(folder.path(), {.cameras = {"cam7"}}),
            "the rig has no camera cam7, it has cam0, cam1 and cam2");
}

TEST(EurocDrive, TheNamesOfColumnsNeedNoHash) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "mav0", {.num_cameras = 1});
  const fs::path csv = folder.path() / "mav0" / "imu0" / "data.csv";
  Edit(csv, "#timestamp", "timestamp");
  const auto log = OpenDriveLog(folder.path());

  EXPECT_EQ(Select<ImuSample>(ReadAll(*log)).size(), 201u);

  EXPECT_TRUE(log->health().damage.IsClean());
}

TEST(EurocDrive, AccelerationsOfACarThatAreSomePercentOffAreCorrected) {
  const TestFolder folder;
  const fs::path mav0 = folder.path() / "mav0";
  WriteEurocFolder(mav0, {.num_cameras = 1, .has_wheels = true});
  std::string imu;
  for (std::int64_t i = 0; i <= 200; ++i)
    imu += std::to_string(1'000'000'000'000 + i * 10'000'000) + ",0,0,0.01,0,0,10.59118\n";
  WriteText(mav0 / "imu0" / "data.csv", imu);
  const auto log = OpenDriveLog(folder.path());

  // 8 % more than gravity.
  EXPECT_NEAR(Select<ImuSample>(ReadAll(*log))[7].linear_acceleration.z(), 9.80665, 1e-4);

  ASSERT_EQ(log->health().findings.size(), 1u);
  EXPECT_EQ(ToText(log->health().findings[0]),
            "the IMU imu0 reads accelerations 8.0 % too large, as it seems: 10.6 m/s2 where "
            "gravity alone makes 9.8; they are used times 0.9259: set accelerometer_scale: 0.9259 "
            "in imu0.yaml");
  fs::remove_all(mav0 / "odom0");  // what flies may pull so much
  EXPECT_NEAR(Select<ImuSample>(ReadAll(*OpenDriveLog(folder.path())))[7].linear_acceleration.z(),
              10.59118, 1e-9);
}

TEST(EurocDrive, SemanticImagesBecomeMasks) {
  const TestFolder folder;
  const fs::path mav0 = folder.path() / "mav0";
  WriteEurocFolder(mav0, {.num_cameras = 1});
  fs::create_directories(mav0 / "cam0" / "semantic" / "data");
  WriteText(mav0 / "cam0" / "semantic" / "data.csv",
            "#timestamp [ns],filename\n1000300000000,1000300000000.png\n");
  const cv::Mat mask(48, 64, CV_8UC1, cv::Scalar(255));
  cv::imwrite((mav0 / "cam0" / "semantic" / "data" / "1000300000000.png").string(), mask);
  const auto log = OpenDriveLog(folder.path());

  ReadOptions options;
  options.semantics = true;

  const auto masks = Select<SemanticFrame>(ReadAll(*log, options));

  ASSERT_EQ(masks.size(), 1u);
  EXPECT_EQ(masks[0].time.ns, 1'000'300'000'000);
  EXPECT_EQ(cv::norm(masks[0].mask, mask, cv::NORM_INF), 0);
  EXPECT_TRUE(Select<SemanticFrame>(ReadAll(*log)).empty());
}

TEST(EurocDrive, WhatIsMissingIsNamedInOneSentence) {
  const TestFolder folder;
  const fs::path mav0 = folder.path() / "mav0";
  WriteEurocFolder(mav0, {.num_cameras = 1});
  EXPECT_EQ(WhatOpeningThrows(folder.path() / "nowhere.bag"), "there is no log nowhere.bag");
  WriteText(mav0 / "cam0" / "sensor.yaml", "sensor_type: camera\nresolution: [64, 48]\n");
  EXPECT_EQ(WhatOpeningThrows(folder.path()), "cam0/sensor.yaml has no 'intrinsics'");
  WriteText(mav0 / "cam0" / "sensor.yaml",
            std::regex_replace(CameraSensorYaml(0), std::regex("64, 48"), "1e300, .nan"));
  EXPECT_EQ(WhatOpeningThrows(folder.path()), "cam0/sensor.yaml has a wrong 'resolution'");
  fs::remove(mav0 / "cam0" / "sensor.yaml");
  EXPECT_EQ(WhatOpeningThrows(folder.path()), "no rig: cam0/sensor.yaml is missing");
  WriteText(mav0 / "cam0" / "sensor.yaml",
            std::regex_replace(CameraSensorYaml(0), std::regex("64, 48"), "80, 48"));
  EXPECT_EQ(WhatOpeningThrows(folder.path()),
            "the rig does not fit the log: camera cam0: the image is 64x48, calibrated is 80x48");
}

TEST(EurocDrive, APassMayBeLeftEarlyAndOutliveItsLog) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "mav0");
  auto log = OpenDriveLog(folder.path());
  const auto left_early = log->Read({});
  const auto outlives = log->Read({});

  ASSERT_TRUE(left_early->Next().has_value());
  log.reset();
  int count = 0;
  while (outlives->Next()) ++count;

  EXPECT_EQ(count, 201 + 42);
}

TEST(EurocDrive, RealClipsComeOutWhole) {
  const struct {
    const char* name;
    std::size_t num_images,
        num_missing;  // the index of the first names four files that are not there
  } clips[] = {
      {"euroc_v101_clip", 190, 4}, {"kitti_06_clip", 102, 0}, {"euroc_v101_moving", 90, 0}};
  for (const auto& clip : clips) {
    const fs::path folder = SharedData() / clip.name;
    if (!fs::exists(folder)) GTEST_SKIP() << "PARKADE_SHARED_DATA has no " << clip.name;

    const auto log = OpenDriveLog(
        folder, {.rig_folder = fs::exists(folder / "rig") ? folder / "rig" : fs::path()});
    const auto records = ReadAll(*log);

    ExpectOrdered(records);
    EXPECT_EQ(Select<CameraFrame>(records).size(), clip.num_images) << clip.name;
    EXPECT_GT(Select<ImuSample>(records).size(), 400u);
    std::size_t num_dropped = 0;
    for (const StreamHealth& stream : log->health().streams) num_dropped += stream.NumDropped();
    EXPECT_EQ(num_dropped, clip.num_missing) << clip.name;
    EXPECT_TRUE(log->health().Warnings().empty());
  }
}

}  // namespace
}  // namespace parkade
