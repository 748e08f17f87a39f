#include <gtest/gtest.h>

#include <cstdlib>

#include "server/ingest/drive/open_drive_log.h"
#include "server/ingest/inspection/inspect_log.h"
#include "tests/server/ingest/drive/euroc_folder.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// A bag that ROS' own writer wrote; false where that is not installed (python3-rosbag).
bool WriteBag(const fs::path& file, const std::string& compression) {
  const std::string command =
      "PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 tests/server/ingest/drive/drive_messages.py '" +
      file.string() + "' " + compression + " 2>/dev/null";
  return std::system(command.c_str()) == 0;
}

class RosbagDrive : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!WriteBag(file_, GetParam())) GTEST_SKIP() << "python3-rosbag is not installed";
  }

  TestFolder folder_;
  const fs::path file_ = folder_.path() / "drive.bag";
};

INSTANTIATE_TEST_SUITE_P(OfficialWriter, RosbagDrive, testing::Values("none", "bz2", "lz4"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(RosbagDrive, EveryRecordComesOutAsWritten) {
  const auto drive = OpenDriveLog(file_);
  int num_imu = 0, num_wheels = 0, num_fixes = 0, num_images = 0;
  Timestamp last;
  const auto stream = drive->Read({});
  while (const auto record = stream->Next()) {
    const std::int64_t ms = (TimeOf(*record).ns - 1'700'000'000'000'000'000) / 1'000'000;
    EXPECT_LE(last, TimeOf(*record));
    last = TimeOf(*record);
    if (const auto* imu = std::get_if<ImuSample>(&*record)) {
      EXPECT_EQ(ms, 5 * num_imu++);
      EXPECT_EQ(imu->angular_velocity.z(), 0.25);
      EXPECT_EQ(imu->linear_acceleration.z(), 9.81);
    } else if (const auto* wheels = std::get_if<WheelSample>(&*record)) {
      EXPECT_EQ(ms, 20 * num_wheels++);
      EXPECT_EQ(wheels->forward_speed, 1.5);
      EXPECT_EQ(wheels->yaw_rate, 0.25);
    } else if (const auto* fix = std::get_if<GnssFix>(&*record)) {
      EXPECT_EQ(ms, 200 * num_fixes++);
      EXPECT_EQ(fix->latitude_deg, 48.1);
      EXPECT_EQ(fix->sigma_enu, Eigen::Vector3d(1, 2, 3));
    } else if (const auto* frame = std::get_if<CameraFrame>(&*record)) {
      EXPECT_EQ(frame->image.type(), CV_8UC1);
      EXPECT_EQ(frame->image.at<std::uint8_t>(10, 10), ms / 50 + 100 * frame->camera);
      ++num_images;
    }
  }
  EXPECT_EQ(num_imu, 601);
  EXPECT_EQ(num_wheels, 151);
  EXPECT_EQ(num_fixes, 16);
  EXPECT_EQ(num_images, 122);
  EXPECT_TRUE(drive->health().Warnings().empty());
}

TEST_P(RosbagDrive, ItsRigIsFoundAlongTheChainOfTransforms) {
  const auto drive = OpenDriveLog(file_);

  const Rig& rig = drive->rig();
  ASSERT_EQ(rig.cameras.size(), 2u);
  EXPECT_EQ(rig.cameras[1].topic, "/cam_left/image_raw/compressed");
  EXPECT_TRUE(rig.cameras[0].body_from_camera.translation.isApprox(Eigen::Vector3d(2, 0, 1.25)));
  EXPECT_TRUE(rig.cameras[1].body_from_camera.translation.isApprox(Eigen::Vector3d(2, 0.5, 1)));
  EXPECT_EQ(std::get<KannalaBrandtProjection>(rig.cameras[0].model.projection()).k2, -0.002);
}

TEST_P(RosbagDrive, InspectCallsItCleanAndACutOneLossy) {
  EXPECT_EQ(InspectLog(file_).ExitStatus(), 0);

  fs::resize_file(file_, fs::file_size(file_) * 2 / 3);
  const LogInspection cut = InspectLog(file_);

  EXPECT_EQ(cut.ExitStatus(), 3);
  EXPECT_TRUE(cut.rig.has_value());
  EXPECT_GT(cut.span.Seconds(), 1);
  EXPECT_FALSE(cut.damage.IsClean());
}

}  // namespace
}  // namespace parkade
