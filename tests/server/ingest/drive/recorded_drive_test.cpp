#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "server/ingest/drive/open_drive_log.h"
#include "tests/server/ingest/drive/euroc_folder.h"
#include "tests/server/ingest/messages/message_writer.h"

namespace parkade {
namespace {

constexpr std::int64_t kBegin = 1'700'000'000'000'000'000, kMs = 1'000'000;

/// What is written into a log, and when. Images are 64 x 48 of one gray value.
struct LogPlan {
  int milliseconds = 3000;
  std::vector<std::string> cameras = {"/cam_front", "/cam_left"};
  std::string image_name = "/image_raw";
  int image_latency_ms = 0;  ///< how much later than its stamp an image stands in the log
  bool has_info = true, has_transforms = true, has_imu = true;
  CameraInfoValues camera = {};
  bool has_twist = true;
};

void AddTransforms(MemorySource& log, const LogPlan& plan) {
  std::vector<TransformValues> transforms = {{"base_link", "imu_link", {0.5, 0, 0.4}}};
  for (std::size_t i = 0; i < plan.cameras.size(); ++i)
    transforms.push_back({"base_link",
                          plan.cameras[i].substr(1),
                          {2, 0.5 * static_cast<double>(i), 1},
                          {-0.5, 0.5, -0.5, 0.5}});
  log.Add("/tf_static", "tf2_msgs/TFMessage", kBegin, TransformBytes(log.Writer(), transforms));
}

MemorySource MakeLog(const LogPlan& plan, MessageEncoding encoding = MessageEncoding::kRos1) {
  MemorySource log(encoding);
  if (plan.has_transforms) AddTransforms(log, plan);
  for (int ms = 0; ms <= plan.milliseconds; ++ms) {
    const std::int64_t now = kBegin + ms * kMs;
    if (plan.has_imu && ms % 5 == 0)
      log.Add("/imu", "sensor_msgs/Imu", now, ImuBytes(log.Writer(), now, "imu_link"));
    const double x = 0.0015 * ms;
    if (ms % 20 == 3)
      log.Add("/odom", "nav_msgs/Odometry", now,
              OdometryBytes(log.Writer(), now, {.x = x, .speed = plan.has_twist ? 1.5 : 0}));
    if (ms % 200 == 7)
      log.Add("/fix", "sensor_msgs/NavSatFix", now, NavSatBytes(log.Writer(), now, 0, 4, 2));
    const int stamp_ms = ms - plan.image_latency_ms;
    for (std::size_t i = 0; i < plan.cameras.size(); ++i) {
      if (stamp_ms < 0 || stamp_ms % 50 != static_cast<int>(7 * i)) continue;
      const std::int64_t stamp = kBegin + stamp_ms * kMs;
      const std::string& camera = plan.cameras[i];
      if (plan.has_info)
        log.Add(camera + "/camera_info", "sensor_msgs/CameraInfo", now,
                CameraInfoBytes(log.Writer(), stamp, camera.substr(1), plan.camera));
      ImageValues image{64, 48, 64, "mono8", false, std::vector<std::uint8_t>(64 * 48)};
      std::fill(image.data.begin(), image.data.end(), static_cast<std::uint8_t>(stamp_ms / 50));
      log.Add(camera + plan.image_name, "sensor_msgs/Image", now,
              ImageBytes(log.Writer(), stamp, camera.substr(1), image));
    }
  }
  return log;
}

std::unique_ptr<RecordedDrive> Open(const MemorySource& log, OpenLogOptions options = {}) {
  options.warn = false;
  return OpenDriveLog(std::make_shared<MemorySource>(log), "drive.bag", options);
}

std::string WhatOpeningThrows(const MemorySource& log, const OpenLogOptions& options = {}) {
  try {
    Open(log, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
    return error.what();
  }
  return "nothing";
}

struct Records {
  std::vector<SensorRecord> all;
  int imu = 0, wheels = 0, fixes = 0, images = 0;
};

Records ReadAll(const DriveLog& drive, const ReadOptions& options = {}) {
  Records records;
  const auto stream = drive.Read(options);
  while (auto record = stream->Next()) {
    if (!records.all.empty()) {
      EXPECT_LE(TimeOf(records.all.back()), TimeOf(*record));
    }
    records.imu += std::holds_alternative<ImuSample>(*record);
    records.wheels += std::holds_alternative<WheelSample>(*record);
    records.fixes += std::holds_alternative<GnssFix>(*record);
    records.images += std::holds_alternative<CameraFrame>(*record);
    records.all.push_back(std::move(*record));
  }
  return records;
}

TEST(RecordedDrive, WhatWasFoundInALogBeforeNeedNotBeFoundAgain) {
  LogPlan plan;
  plan.has_twist = false;  // of which a note is made
  const MemorySource log = MakeLog(plan);
  std::string kept, name;
  int num_found = 0;
  const OpenLogOptions keeping{
      .keep_survey = [&](const std::string& drive, const std::function<std::string()>& find) {
        name = drive;
        if (kept.empty()) ++num_found, kept = find();
        return kept;
      }};

  const auto drive = Open(log), first = Open(log, keeping), again = Open(log, keeping);

  EXPECT_EQ(num_found, 1);
  EXPECT_EQ(name, "drive");
  EXPECT_FALSE(drive->health().findings.empty());
  const std::string health = HealthToJson(drive->health()).dump();
  const Records records = ReadAll(*drive);
  for (const RecordedDrive* same : {first.get(), again.get()}) {
    EXPECT_EQ(HealthToJson(same->health()).dump(), health);
    EXPECT_EQ(same->span().begin, drive->span().begin);
    EXPECT_EQ(same->span().end, drive->span().end);
    const Records of_same = ReadAll(*same);
    ASSERT_EQ(records.all.size(), of_same.all.size());
    EXPECT_EQ(records.wheels, of_same.wheels);
    for (size_t i = 0; i < records.all.size(); ++i)
      ASSERT_EQ(TimeOf(records.all[i]), TimeOf(of_same.all[i]));
  }
}

TEST(RecordedDrive, OfALogThatCannotBeUsedNothingIsKept) {
  LogPlan plan;
  plan.has_imu = false;
  bool is_kept = false;
  const OpenLogOptions keeping{
      .keep_survey = [&](const std::string&, const std::function<std::string()>& find) {
        std::string bytes = find();
        is_kept = true;
        return bytes;
      }};
  EXPECT_THROW(Open(MakeLog(plan), keeping), Error);
  EXPECT_FALSE(is_kept);
}

TEST(RecordedDrive, BothEncodingsDeliverTheSameRecords) {
  for (const MessageEncoding encoding : {MessageEncoding::kRos1, MessageEncoding::kCdr}) {
    const auto drive = Open(MakeLog({}, encoding));
    const Records records = ReadAll(*drive);

    EXPECT_EQ(records.imu, 601);
    EXPECT_EQ(records.wheels, 150);
    EXPECT_EQ(records.fixes, 15);
    EXPECT_EQ(records.images, 61 + 60);
    EXPECT_TRUE(drive->health().Warnings().empty());
    for (const SensorRecord& record : records.all)
      if (const auto* frame = std::get_if<CameraFrame>(&record)) {
        const auto stamp_ms = (frame->time.ns - kBegin) / kMs;
        EXPECT_EQ(frame->image.at<std::uint8_t>(20, 20), stamp_ms / 50);
        EXPECT_EQ(stamp_ms % 50, frame->camera * 7);
      }
  }
}

TEST(RecordedDrive, LateImagesAreSortedIn) {
  for (const int latency : {1, 80, 400, 1900}) {
    const auto drive = Open(MakeLog({.milliseconds = 6000, .image_latency_ms = latency}));

    const Records records = ReadAll(*drive);  // checks the order

    EXPECT_EQ(records.imu, 1201);
    EXPECT_GT(records.images, 150);
    EXPECT_FALSE(drive->health().streams.empty());
    for (const StreamHealth& stream : drive->health().streams)
      EXPECT_EQ(stream.NumDropped(), 0u) << latency;
  }
}

TEST(RecordedDrive, WhatIsLaterThanTheWindowIsCountedNotDelivered) {
  const auto drive = Open(MakeLog({.milliseconds = 8000, .image_latency_ms = 3000}));

  const Records records = ReadAll(*drive);

  EXPECT_EQ(records.imu, 1601);
  EXPECT_GT(drive->health().streams[3].Dropped(DropReason::kLate), 50u);
}

TEST(RecordedDrive, WhoChoosesSomeImagesChangesNoRates) {
  const auto drive = Open(MakeLog({}));
  const std::uint64_t before = drive->health().streams[3].num_delivered;
  ReadOptions options;
  options.wants_image = [](int camera, Timestamp) { return camera == 1; };

  const Records records = ReadAll(*drive, options);

  EXPECT_EQ(records.images, 60);
  for (const StreamHealth& stream : drive->health().streams)
    EXPECT_GT(stream.num_delivered, 1u) << stream.role;
  EXPECT_EQ(drive->health().streams[3].num_delivered, before);
  ReadAll(*drive);
  EXPECT_EQ(drive->health().streams[3].num_delivered, before) << "a whole pass counts as before";
}

TEST(RecordedDrive, TheRigComesFromCameraInfoAndStaticTransforms) {
  const auto drive = Open(MakeLog({}));

  const Rig& rig = drive->rig();
  ASSERT_EQ(rig.cameras.size(), 2u);
  EXPECT_EQ(rig.cameras[0].name, "cam0");
  EXPECT_EQ(rig.cameras[0].topic, "/cam_front/image_raw");
  EXPECT_TRUE(rig.vehicle.has_value());
  EXPECT_TRUE(rig.body_from_imu.translation.isApprox(Eigen::Vector3d(0.5, 0, 0.4)));
  EXPECT_TRUE(rig.cameras[1].body_from_camera.translation.isApprox(Eigen::Vector3d(2, 0.5, 1)));
  EXPECT_TRUE((rig.cameras[0].body_from_camera.rotation * Eigen::Vector3d::UnitZ())
                  .isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_NEAR(rig.imu.update_rate, 200, 1);
  const auto& lens = std::get<RadTanProjection>(rig.cameras[0].model.projection());
  EXPECT_EQ(lens.fx, 40);
  EXPECT_EQ(lens.fy, 41);
  EXPECT_EQ(lens.distortion.k3, 0.003);
}

TEST(RecordedDrive, TheTopicsThatARigLeavesOutAreFilledIn) {
  const TestFolder folder;
  Rig rig = Open(MakeLog({}))->rig();
  rig.imu.topic.clear();
  WriteRig(rig, folder.path());

  const auto drive = Open(MakeLog({}), {.rig_folder = folder.path()});

  EXPECT_EQ(drive->rig().imu.topic, "/imu");
  EXPECT_EQ(ReadAll(*drive).imu, 601);
}

TEST(RecordedDrive, ATopicMayBeNamedAsItsCamera) {
  const auto drive = Open(MakeLog({.image_name = ""}));

  ASSERT_EQ(drive->rig().cameras.size(), 2u);
  EXPECT_EQ(drive->rig().cameras[1].topic, "/cam_left");
  EXPECT_EQ(
      WhatOpeningThrows(MakeLog({.image_name = "", .has_info = false, .has_transforms = false})),
      "no rig: camera /cam_front has no CameraInfo, camera /cam_left has no CameraInfo and "
      "/tf_static has no "
      "transform from imu_link to cam_front and cam_left");
}

TEST(RecordedDrive, VendorsSpellingsOfTheFisheyeLensAreKnown) {
  for (const std::string spelling : {"equidistant", "fisheye", "kannala_brandt"}) {
    // Some vendors write a fifth coefficient, which is 0.
    const CameraInfoValues lens{.model = spelling, .distortion = {-0.1, 0.01, 0.001, 0.002, 0}};
    const auto drive = Open(MakeLog({.camera = lens}));
    EXPECT_TRUE(std::holds_alternative<KannalaBrandtProjection>(
        drive->rig().cameras[0].model.projection()));
  }
  EXPECT_EQ(WhatOpeningThrows(MakeLog({.camera = {.model = "thin_prism"}})),
            "camera /cam_front has the distortion model 'thin_prism', which Parkade does not know: "
            "bring a rig");
}

TEST(RecordedDrive, WhatTheRigLacksIsNamedInOneSentence) {
  EXPECT_EQ(WhatOpeningThrows(
                MakeLog({.cameras = {"/cam_left"}, .has_info = false, .has_transforms = false})),
            "no rig: camera /cam_left has no CameraInfo and /tf_static has no transform from "
            "imu_link to cam_left");
  EXPECT_EQ(WhatOpeningThrows(MakeLog({.has_transforms = false})),
            "no rig: /tf_static has no transform from imu_link to cam_front and cam_left");
  EXPECT_EQ(WhatOpeningThrows(MakeLog({.has_imu = false})),
            "the log has no IMU (no topic of type sensor_msgs/Imu)");
  EXPECT_EQ(WhatOpeningThrows(MakeLog({.cameras = {}})), "the log has no images");
}

TEST(RecordedDrive, AnUncalibratedCameraIsNamed) {
  MemorySource log = MakeLog({.cameras = {"/cam_left"}, .has_info = false});
  log.Add("/cam_left/camera_info", "sensor_msgs/CameraInfo", kBegin,
          CameraInfoBytes(log.Writer(), kBegin, "cam_left",
                          {.model = "", .distortion = {}, .focal = 0}));

  EXPECT_EQ(WhatOpeningThrows(log),
            "camera /cam_left is not calibrated: the focal length in its CameraInfo is 0");
}

TEST(RecordedDrive, ATwistThatIsAlwaysZeroGivesWayToThePose) {
  const auto drive = Open(MakeLog({.has_twist = false}));

  const Records records = ReadAll(*drive);

  EXPECT_EQ(records.wheels, 149);
  for (const SensorRecord& record : records.all)
    if (const auto* sample = std::get_if<WheelSample>(&record)) {
      EXPECT_NEAR(sample->forward_speed, 1.5, 1e-6);
    }
  EXPECT_EQ(drive->health().Warnings().size(), 1u);
  for (const StreamHealth& stream : drive->health().streams) EXPECT_EQ(stream.NumDropped(), 0u);
}

TEST(RecordedDrive, ACameraOnAnotherClockLosesNothingButItself) {
  MemorySource log = MakeLog({});
  const ImageValues image{64, 48, 64, "mono8", false, std::vector<std::uint8_t>(64 * 48)};
  const LogPlan plan;
  MemorySource skewed;
  AddTransforms(skewed, plan);
  for (int ms = 0; ms <= 3000; ++ms) {
    const std::int64_t now = kBegin + ms * kMs;
    if (ms % 5 == 0)
      skewed.Add("/imu", "sensor_msgs/Imu", now, ImuBytes(skewed.Writer(), now, "imu_link"));
    for (std::size_t i = 0; i < 2; ++i) {
      if (ms % 50 != 0) continue;
      const std::int64_t stamp = now + (i == 1 ? 3'600'000 * kMs : 0);
      const std::string frame = plan.cameras[i].substr(1);
      skewed.Add(plan.cameras[i] + "/camera_info", "sensor_msgs/CameraInfo", now,
                 CameraInfoBytes(log.Writer(), stamp, frame));
      skewed.Add(plan.cameras[i] + "/image_raw", "sensor_msgs/Image", now,
                 ImageBytes(log.Writer(), stamp, frame, image));
    }
  }

  const auto drive = Open(skewed);
  const Records records = ReadAll(*drive);

  EXPECT_EQ(records.imu, 601);
  EXPECT_EQ(records.images, 61);
  EXPECT_EQ(drive->health().streams[2].Dropped(DropReason::kOffClock), 61u);
  EXPECT_LT(drive->span().Seconds(), 3.1);
  const std::vector<std::string> warnings = drive->health().Warnings();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("camera cam1 (/cam_left/image_raw) is left out"), std::string::npos)
      << warnings[0];
  EXPECT_NE(warnings[0].find("60 min ahead of it"), std::string::npos) << warnings[0];
}

TEST(RecordedDrive, AGapOfAnHourMakesTwoDrives) {
  MemorySource log;
  AddTransforms(log, {});
  const ImageValues image{64, 48, 64, "mono8", false, std::vector<std::uint8_t>(64 * 48)};
  for (int ms = 0; ms < 8000; ++ms) {
    const std::int64_t now = kBegin + (ms + (ms >= 3000 ? 3'600'000LL : 0)) * kMs;
    if (ms % 5 == 0)
      log.Add("/imu", "sensor_msgs/Imu", now, ImuBytes(log.Writer(), now, "imu_link"));
    for (const std::string camera : {"cam_front", "cam_left"}) {
      if (ms % 50 != 0) continue;
      log.Add("/" + camera + "/camera_info", "sensor_msgs/CameraInfo", now,
              CameraInfoBytes(log.Writer(), now, camera));
      log.Add("/" + camera + "/image_raw", "sensor_msgs/Image", now,
              ImageBytes(log.Writer(), now, camera, image));
    }
  }

  const auto drives =
      OpenDriveLogs(std::make_shared<MemorySource>(log), "drive.bag", {.warn = false});
  ASSERT_EQ(drives.size(), 2u);
  EXPECT_EQ(drives[0]->name(), "drive") << "the longer one";
  EXPECT_EQ(drives[1]->name(), "drive_part2");
  const Records first = ReadAll(*drives[1]), second = ReadAll(*drives[0]);
  EXPECT_EQ(first.imu, 600);
  EXPECT_EQ(second.imu, 1000);
  EXPECT_EQ(first.images + second.images, 2 * 160);
  EXPECT_LT(drives[0]->health().streams[0].longest_gap, 0.1);
  EXPECT_EQ(drives[0]->health().findings.front().name, "recording_pauses");
}

TEST(RecordedDrive, ARigFolderIsMatchedToTopicsAndShiftsTheImages) {
  const TestFolder folder;
  const std::string camera =
      "  camera_model: pinhole\n  intrinsics: [40, 40, 31.5, 23.5]\n  distortion_model: radtan\n"
      "  distortion_coeffs: [0, 0, 0, 0]\n  resolution: [64, 48]\n  timeshift_cam_imu: 0.012\n  "
      "T_cam_imu:\n"
      "  - [0, -1, 0, 0]\n  - [0, 0, -1, 0]\n  - [1, 0, 0, 0]\n  - [0, 0, 0, 1]\n";
  const auto write = [&](const std::string& topic, const std::string& imu) {
    WriteText(folder.path() / "camchain-imucam.yaml",
              "cam0:\n" + camera + "  rostopic: " + topic + "\n");
    WriteText(folder.path() / "imu0.yaml",
              "rostopic: " + imu +
                  "\nupdate_rate: 200\naccelerometer_noise_density: "
                  "0.02\naccelerometer_random_walk: 0.001\n"
                  "gyroscope_noise_density: 0.001\ngyroscope_random_walk: 0.00001\n");
  };
  OpenLogOptions options;
  options.rig_folder = folder.path();

  write("cam_left/image_raw/compressed", "imu");
  const auto drive = Open(MakeLog({}), options);
  ReadOptions only_images;
  only_images.imu = only_images.wheels = only_images.gnss = false;
  EXPECT_EQ(TimeOf(*drive->Read(only_images)->Next()).ns, kBegin + (7 + 12) * kMs);
  ASSERT_EQ(drive->health().Warnings().size(), 1u);
  EXPECT_NE(drive->health().Warnings()[0].find("no vehicle.yaml"), std::string::npos);

  write("/other/image_raw", "/imu");
  EXPECT_EQ(WhatOpeningThrows(MakeLog({}), options),
            "none of the rig's cameras is in the log: the rig has cam0 (/other/image_raw), the log "
            "/cam_front/image_raw "
            "and /cam_left/image_raw");
  write("/cam_left/image_raw", "/imu/data");
  EXPECT_EQ(WhatOpeningThrows(MakeLog({}), options),
            "the rig's IMU topic /imu/data is not in the log, which has /imu");
}

/// A second of images of one camera, each fifth of them with a stray byte that libjpeg forgives.
MemorySource LogOfJpegs() {
  MemorySource log = MakeLog({.milliseconds = 1000, .cameras = {"/cam_front"}});
  std::vector<std::uint8_t> whole;
  cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC1, cv::Scalar(90)), whole);
  std::vector<std::uint8_t> damaged = whole;
  damaged.insert(damaged.end() - 2, 1);
  for (int i = 0; i < 20; ++i) {
    const std::int64_t stamp = kBegin + 50 * i * kMs;
    log.Add("/cam_left/camera_info", "sensor_msgs/CameraInfo", stamp,
            CameraInfoBytes(log.Writer(), stamp, "cam_left"));
    log.Add("/cam_left/image_raw/compressed", "sensor_msgs/CompressedImage", stamp,
            CompressedImageBytes(log.Writer(), stamp, "cam_left", i % 5 == 3 ? damaged : whole));
  }
  return log;
}

TEST(RecordedDrive, EveryPassLeavesOutDamagedImages) {
  MemorySource log = LogOfJpegs();
  log.Add(
      "/tf_static", "tf2_msgs/TFMessage", kBegin,
      TransformBytes(log.Writer(), {{"base_link", "cam_left", {2, 0, 1}, {-0.5, 0.5, -0.5, 0.5}}}));
  const auto drive = Open(log);

  for (int pass = 0; pass < 3; ++pass) {
    EXPECT_EQ(ReadAll(*drive).images, 21 + 16) << "of two cameras";
    EXPECT_EQ(drive->health().streams.back().Dropped(DropReason::kDamaged), 4u);
  }
}

TEST(RecordedDrive, EveryPassIsTheSameWhateverTheThreads) {
  const MemorySource log = MakeLog({.milliseconds = 4000, .image_latency_ms = 60});
  std::vector<std::string> passes;
  for (const int threads : {1, 2, 4}) {
    OpenLogOptions options;
    options.num_decode_threads = threads;
    std::string pass;
    for (const SensorRecord& record : ReadAll(*Open(log, options)).all)
      pass += std::to_string(record.index()) + "@" + std::to_string(TimeOf(record).ns) + " ";
    passes.push_back(pass);
  }

  EXPECT_EQ(passes[0], passes[1]);
  EXPECT_EQ(passes[0], passes[2]);
}

}  // namespace
}  // namespace parkade
