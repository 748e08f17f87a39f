#include "server/ingest/conversion/convert_log.h"

#include <gtest/gtest.h>

#include <functional>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "server/ingest/containers/open_message_source.h"
#include "server/ingest/inspection/inspect_log.h"
#include "server/ingest/messages/message_decoding.h"
#include "tests/server/ingest/drive/euroc_folder.h"
#include "tests/server/ingest/messages/message_writer.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kBegin = 1'700'000'000'000'000'000, kMs = 1'000'000;

std::vector<SensorRecord> ReadAll(const DriveLog& drive) {
  std::vector<SensorRecord> records;
  ReadOptions options;
  options.semantics = true;
  options.grayscale = false;
  const auto stream = drive.Read(options);
  while (auto record = stream->Next()) records.push_back(std::move(*record));
  return records;
}

/// A record as text, with all its numbers.
std::string Describe(const SensorRecord& record) {
  std::ostringstream text;
  text.precision(17);
  text << TimeOf(record).ns << ' ';
  if (const auto* imu = std::get_if<ImuSample>(&record)) {
    text << "imu " << imu->angular_velocity.transpose() << ' '
         << imu->linear_acceleration.transpose();
  } else if (const auto* wheels = std::get_if<WheelSample>(&record)) {
    text << "wheels " << wheels->forward_speed << ' ' << wheels->yaw_rate;
  } else if (const auto* fix = std::get_if<GnssFix>(&record)) {
    text << "fix " << fix->latitude_deg << ' ' << fix->longitude_deg << ' ' << fix->altitude << ' '
         << fix->sigma_enu.transpose();
  } else if (const auto* frame = std::get_if<CameraFrame>(&record)) {
    text << "image " << frame->camera << ' ' << cv::sum(frame->image) << ' '
         << frame->image.channels();
  } else {
    text << "mask " << std::get<SemanticFrame>(record).camera;
  }
  return text.str();
}

void ExpectSameRecords(const DriveLog& drive, const DriveLog& other) {
  const std::vector<SensorRecord> records = ReadAll(drive), others = ReadAll(other);
  ASSERT_EQ(records.size(), others.size());
  for (std::size_t i = 0; i < records.size(); ++i)
    ASSERT_EQ(Describe(records[i]), Describe(others[i])) << i;
}

Rig RigOfTest(double time_shift = 0) {
  Rig rig;
  rig.imu.topic = "/imu";
  rig.vehicle = VehicleCalibration{};
  RigCamera& camera = rig.cameras.emplace_back();
  camera.name = "cam0";
  camera.topic = "/front/image_raw";
  camera.model = CameraModel(PinholeProjection{40, 40, 31.5, 23.5}, 64, 48);
  camera.time_shift = time_shift;
  return rig;
}

/// What messages of a log are changed into; nothing is dropped.
struct Faults {
  std::function<std::int64_t(int)> imu_stamp_ms = [](int ms) { return ms; };
  std::function<std::int64_t(int)> image_stamp_ms = [](int ms) { return ms; };
  int milliseconds = 6000;
  double speed = 1.5;  // [m/s] that the wheels say; 0: nor do they say any turn
};

MemorySource MakeLog(const Faults& faults) {
  MemorySource log;
  for (int ms = 0; ms < faults.milliseconds; ++ms) {
    const std::int64_t now = kBegin + ms * kMs;
    if (ms % 5 == 0)
      log.Add("/imu", "sensor_msgs/Imu", now,
              ImuBytes(log.Writer(), kBegin + faults.imu_stamp_ms(ms) * kMs));
    if (ms % 20 == 3)
      log.Add("/odom", "nav_msgs/Odometry", now,
              OdometryBytes(log.Writer(), kBegin + faults.imu_stamp_ms(ms) * kMs,
                            {.x = 0.001 * faults.speed * ms,
                             .speed = faults.speed,
                             .yaw_rate = faults.speed == 0 ? 0 : 0.1}));
    if (ms % 100 != 7) continue;
    ImageValues image{64, 48, 192, "rgb8", false, std::vector<std::uint8_t>(192 * 48)};
    for (std::size_t i = 0; i < image.data.size(); ++i)
      image.data[i] = static_cast<std::uint8_t>(7 * i + static_cast<std::size_t>(ms));
    log.Add("/front/image_raw", "sensor_msgs/Image", now,
            ImageBytes(log.Writer(), kBegin + faults.image_stamp_ms(ms) * kMs, "front", image));
  }
  return log;
}

class ConvertLogTest : public testing::Test {
 protected:
  Conversion Convert(const MemorySource& log, const Rig& rig) {
    fs::create_directories(rig_);
    WriteRig(rig, rig_);
    return ConvertLog(std::make_shared<MemorySource>(log), "log", out_, Options(rig_));
  }

  static OpenLogOptions Options(const fs::path& rig) { return {.rig_folder = rig, .warn = false}; }

  TestFolder folder_;
  fs::path rig_ = folder_.path() / "rig";
  fs::path out_ = folder_.path() / "drive.mcap";
};

TEST_F(ConvertLogTest, AFolderBecomesOneLogOfTheSameRecords) {
  const fs::path mav0 = folder_.path() / "euroc" / "mav0";
  WriteEurocFolder(mav0, {.has_wheels = true, .has_gnss = true});

  const Conversion conversion = ConvertLog(mav0, out_, {.warn = false});

  ASSERT_EQ(conversion.drives.size(), 1U);
  EXPECT_EQ(conversion.drives[0].file, out_);
  EXPECT_EQ(conversion.drives[0].num_messages, 201U + 101 + 3 + 2 * 21);
  EXPECT_EQ(conversion.drives[0].num_left_out, 0U);
  EXPECT_EQ(conversion.rig, folder_.path() / "drive_rig");
  EXPECT_EQ(InspectLog(out_, conversion.rig).ExitStatus(), 0);
  ExpectSameRecords(*OpenDriveLog(mav0, {.warn = false}),
                    *OpenDriveLog(out_, Options(conversion.rig)));
}

TEST_F(ConvertLogTest, FilesOfImagesStayAsTheyAre) {
  const fs::path mav0 = folder_.path() / "euroc" / "mav0";
  WriteEurocFolder(mav0, {.num_cameras = 1});

  ConvertLog(mav0, out_, {.warn = false});

  const auto source = OpenMessageSource(out_);
  std::vector<bool> wanted;
  for (const TopicInfo& topic : source->topics()) {
    wanted.push_back(topic.topic == "/cam0/compressed");
    EXPECT_TRUE(topic.schema->find("MSG: std_msgs/Header") != std::string::npos);
  }
  const auto message = source->Read(wanted)->Next();
  ASSERT_TRUE(message.has_value());
  const CompressedImageMessage image =
      DecodeCompressedImage(message->data, MessageEncoding::kCdr, "sensor_msgs/CompressedImage");
  const std::string file = ReadFile(mav0 / "cam0" / "data" / "1000000000000.png");
  EXPECT_EQ(image.format, "png");
  EXPECT_EQ(image.header.frame_id, "cam0");
  EXPECT_EQ(std::string(image.data.begin(), image.data.end()), file);
}

TEST_F(ConvertLogTest, ShiftsAndScalesAreApplied) {
  Rig rig = RigOfTest(/*time_shift=*/0.02);
  rig.imu.accelerometer_scale = 1.01;
  rig.imu.gyroscope_scale = 2;
  rig.vehicle->wheel_scale = 0.5;
  const MemorySource log = MakeLog({});

  const Conversion conversion = Convert(log, rig);

  const auto drive = OpenDriveLog(out_, Options(conversion.rig));
  ExpectSameRecords(*OpenDriveLog(std::make_shared<MemorySource>(log), "log", Options(rig_)),
                    *drive);
  EXPECT_EQ(drive->rig().cameras[0].time_shift, 0);
  EXPECT_EQ(drive->rig().imu.accelerometer_scale, 1);
  EXPECT_EQ(drive->rig().vehicle->wheel_scale, 1);
  EXPECT_EQ(drive->rig().vehicle->wheel_topic, "/odom");
}

TEST_F(ConvertLogTest, AClockThatStepsAloneIsPutBackForGood) {
  Faults faults;
  faults.image_stamp_ms = [](int ms) { return ms < 3000 ? ms : ms - 1500; };
  const MemorySource log = MakeLog(faults);

  const Conversion conversion = Convert(log, RigOfTest());

  EXPECT_FALSE(OpenDriveLog(std::make_shared<MemorySource>(log), "log", Options(rig_))
                   ->health()
                   .Warnings()
                   .empty());
  const LogInspection inspection = InspectLog(out_, conversion.rig);
  EXPECT_EQ(inspection.ExitStatus(), 0) << InspectionToText(inspection);
  EXPECT_EQ(conversion.drives.at(0).num_left_out, 0U);
}

TEST_F(ConvertLogTest, ASensorOfWhichNothingIsLeftIsNotInTheRig) {
  Rig rig = RigOfTest();
  rig.cameras.push_back(rig.cameras[0]);
  rig.cameras[1].name = "cam1";
  rig.cameras[1].topic = "/rear/image_raw";
  MemorySource log = MakeLog({});
  ImageValues image{64, 48, 64, "mono8", false, std::vector<std::uint8_t>(64 * 48)};
  for (int i = 0; i < 60; ++i)  // on another clock
    log.Add("/rear/image_raw", "sensor_msgs/Image", kBegin + 100 * i * kMs,
            ImageBytes(log.Writer(), (100 * i + 7) * kMs, "rear", image));

  const Conversion conversion = Convert(log, rig);

  EXPECT_EQ(conversion.drives.at(0).num_left_out, 60U);
  const Rig clean = ReadRig(conversion.rig);
  ASSERT_EQ(clean.cameras.size(), 1U);
  EXPECT_EQ(clean.cameras[0].topic, "/front/image_raw");
}

TEST_F(ConvertLogTest, AStreamThatIsLeftOutWholeCounts) {
  const Conversion conversion = Convert(MakeLog({.speed = 0}), RigOfTest());

  EXPECT_EQ(conversion.drives.at(0).num_left_out, 300U);
  EXPECT_EQ(ReadRig(conversion.rig).vehicle->wheel_topic, "");
}

TEST_F(ConvertLogTest, EachStretchBetweenLeapsIsALogOfItsOwn) {
  const auto leap = [](int ms) { return ms < 4000 ? ms : ms + 600'000; };
  const MemorySource log =
      MakeLog({.imu_stamp_ms = leap, .image_stamp_ms = leap, .milliseconds = 7000});

  const Conversion conversion = Convert(log, RigOfTest());

  ASSERT_EQ(conversion.drives.size(), 2U);
  EXPECT_EQ(conversion.drives[1].file, folder_.path() / "drive_part2.mcap");
  EXPECT_NEAR(conversion.drives[0].seconds, 4, 0.02);
  EXPECT_NEAR(conversion.drives[1].seconds, 3, 0.02);
  for (const ConvertedDrive& drive : conversion.drives)
    EXPECT_EQ(InspectLog(drive.file, conversion.rig).ExitStatus(), 0);
}

TEST_F(ConvertLogTest, NothingIsOverwrittenAndARefusalLeavesNothing) {
  Convert(MakeLog({}), RigOfTest());
  const std::string before = ReadFile(out_);

  EXPECT_THROW(Convert(MakeLog({}), RigOfTest()), Error);
  EXPECT_EQ(ReadFile(out_), before);
  fs::remove(out_);
  EXPECT_THROW(Convert(MakeLog({}), RigOfTest()), Error) << "the rig is there still";
  fs::remove_all(folder_.path() / "drive_rig");
  EXPECT_THROW(Convert(MemorySource{}, RigOfTest()), Error);

  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(folder_.path()))
    left.push_back(entry.path().filename());
  EXPECT_EQ(left, std::vector<std::string>{"rig"});
}

}  // namespace
}  // namespace parkade
