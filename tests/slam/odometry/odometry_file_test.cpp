#include "slam/odometry/odometry_file.h"

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>

#include <fstream>

#include "core/error.h"
#include "core/files/file.h"
#include "slam/smoother/drive_measurements.h"
#include "tests/slam/worlds/estimated_drive.h"
#include "tests/support/sanitizers.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

struct TrackedDrive {
  SampledDrive drive = MakeCarDrive({.seed = 3,
                                     .duration = 12,
                                     .camera_rate = 10,
                                     .num_cameras = 2,
                                     .tracks = 40,
                                     .rig_rotation_deg = 0.2});
  OdometryResult odometry = EstimateDrive(drive);
};

const TrackedDrive& Tracked() {
  static const TrackedDrive tracked;
  return tracked;
}

class OdometryFile : public testing::Test {
 protected:
  ~OdometryFile() override { fs::remove(file_); }

  const fs::path file_ =
      fs::path(testing::TempDir()) / ("odometry_" + std::to_string(::getpid()) + ".bin");
};

TEST_F(OdometryFile, ReadAndWrittenAgainItHasTheSameBytes) {
  const TrackedDrive& tracked = Tracked();
  WriteOdometry(tracked.odometry, tracked.drive.rig, file_);
  const std::string bytes = ReadFile(file_);

  const OdometryResult read = ReadOdometry(file_, tracked.drive.rig);
  WriteOdometry(read, tracked.drive.rig, file_);

  EXPECT_EQ(read.odom_from_body.states().size(), tracked.odometry.odom_from_body.states().size());
  EXPECT_EQ(read.keyframes.size(), tracked.odometry.keyframes.size());
  EXPECT_EQ(read.landmarks.size(), tracked.odometry.landmarks.size());
  EXPECT_EQ(read.report.calibration.size(), tracked.odometry.report.calibration.size());
  EXPECT_EQ(read.measurements->num_images(), tracked.odometry.measurements->num_images());
  EXPECT_GT(bytes.size(), 100'000U);
  EXPECT_TRUE(ReadFile(file_) == bytes);
}

TEST_F(OdometryFile, AloneItIsTheSameWithoutMeasurements) {
  const TrackedDrive& tracked = Tracked();
  WriteOdometry(tracked.odometry, tracked.drive.rig, file_);
  const OdometryResult whole = ReadOdometry(file_, tracked.drive.rig);
  OdometryResult alone = ReadOdometryAlone(file_, tracked.drive.rig);
  EXPECT_FALSE(alone.measurements);
  alone.measurements = whole.measurements;
  const std::string bytes = ReadFile(file_);
  WriteOdometry(alone, tracked.drive.rig, file_);
  EXPECT_TRUE(ReadFile(file_) == bytes);

  fs::resize_file(file_, 1000);
  EXPECT_THROW(ReadOdometryAlone(file_, tracked.drive.rig), Error);
}

TEST_F(OdometryFile, DamageAndOtherRigsAreNamed) {
  const TrackedDrive& tracked = Tracked();
  const auto reads = [&](const Rig& rig) { return ReadOdometry(file_, rig); };
  EXPECT_THROW(reads(tracked.drive.rig), Error) << "it is not there";
  WriteOdometry(tracked.odometry, tracked.drive.rig, file_);
  Rig other = tracked.drive.rig;
  other.cameras.front().name = "another";
  EXPECT_THROW(reads(other), Error);
  Rig corrected = tracked.drive.rig;
  corrected.cameras.back().body_from_camera.translation.x() += 1e-3;
  EXPECT_THROW(reads(corrected), Error);
  EXPECT_NO_THROW(reads(tracked.drive.rig));

  const std::string bytes = ReadFile(file_);
  for (const size_t at :
       {size_t{3}, size_t{17}, size_t{22}, size_t{33}, bytes.size() / 2, bytes.size() - 1}) {
    std::string damaged = bytes;
    damaged[at] ^= 4;
    WriteFileAtomically(file_, damaged);
    EXPECT_THROW(reads(tracked.drive.rig), Error) << at;
  }
  for (const size_t size : {size_t{0}, size_t{10}, size_t{30}, bytes.size() - 100}) {
    WriteFileAtomically(file_, bytes.substr(0, size));
    EXPECT_THROW(reads(tracked.drive.rig), Error) << size;
  }
}

/// Measurements of an hour: 100 MB of images.
OdometryResult LongOdometry(const TrackedDrive& tracked) {
  OdometryResult odometry;
  odometry.odom_from_body = tracked.odometry.odom_from_body;
  odometry.rig = tracked.drive.rig;
  auto measurements = std::make_shared<DriveMeasurements>(odometry.rig.imu);
  RecordedImage image;
  image.observations.resize(1000);
  for (int i = 0; i < 3500; ++i) measurements->AddImage(image);
  odometry.measurements = std::move(measurements);
  return odometry;
}

/// Ends the process, with 0 where `work` makes do with 16 MiB more than there are.
template <typename Work>
[[noreturn]] void EndAfterWorkInLittleMemory(const Work& work) {
  ::malloc_trim(0);
  std::ifstream statm("/proc/self/statm");
  rlim_t pages = 0;
  statm >> pages;
  const rlim_t bytes = pages * 4096 + (rlim_t{16} << 20);
  const rlimit limit{bytes, bytes};
  ::setrlimit(RLIMIT_AS, &limit);
  try {
    work();
  } catch (const std::bad_alloc&) {
    ::_exit(1);
  }
  ::_exit(0);
}

TEST_F(OdometryFile, ADriveOfAnyLengthIsWrittenAndReadInLittleMemory) {
  if (kHasSanitizer) GTEST_SKIP() << "sanitizers have an allocator of their own";
  // What is tracked here is not part of the work: the process that dies begins anew.
  const TrackedDrive& tracked = Tracked();
  const auto write_and_read = [&] {
    const OdometryResult odometry = LongOdometry(tracked);
    WriteOdometry(odometry, odometry.rig, file_);
    ReadOdometry(file_, odometry.rig);
    const bool is_long = fs::file_size(file_) > std::uintmax_t{90} << 20;
    fs::remove(file_);
    if (!is_long) ::_exit(2);
  };
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_EXIT(EndAfterWorkInLittleMemory(write_and_read), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace parkade
