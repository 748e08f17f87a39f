#include "slam/odometry/standstill_detector.h"

#include <gtest/gtest.h>

#include "tests/support/sampled_drive.h"

namespace parkade {
namespace {

class Detected {
 public:
  explicit Detected(const SampledDrive& drive)
      : drive_(drive), detector_(drive.rig.imu, drive.rig.cameras.size(), {}) {
    for (const ImuSample& sample : drive.imu) imu_.Add(sample);
    for (const WheelSample& sample : drive.wheels) wheels_.Add(sample);
    for (const TrackedFrame& frame : drive.frames) detector_.Add(frame);
  }

  bool IsStill(double begin, double end) const {
    const Timestamp zero = drive_.imu.front().time;
    return detector_.IsStill(imu_, wheels_, zero + begin, zero + end);
  }

 private:
  const SampledDrive& drive_;
  ImuBuffer imu_;
  WheelBuffer wheels_;
  StandstillDetector detector_;
};

SampledDriveOptions Options(double start, bool has_wheels) {
  SampledDriveOptions options;
  options.start = start;
  options.duration = 3;
  options.has_wheels = has_wheels;
  return options;
}

TEST(StandstillDetector, KnowsAStandingCarWithAndWithoutWheels) {
  for (const bool has_wheels : {true, false}) {
    const SampledDrive drive = MakeRestingDrive(Options(0, has_wheels));
    EXPECT_TRUE(Detected(drive).IsStill(1, 1.5)) << has_wheels;
  }
}

TEST(StandstillDetector, KnowsAMovingCarWithAndWithoutWheels) {
  for (const bool has_wheels : {true, false})
    for (const double start : {8.0, 12.0, 25.0, 40.0}) {
      const SampledDrive drive = MakeCarDrive(Options(start, has_wheels));
      EXPECT_FALSE(Detected(drive).IsStill(1, 1.5)) << has_wheels << " " << start;
    }
}

TEST(StandstillDetector, WhatMovesWithTheCarDoesNotPassForTheWorld) {
  // More than half of what a front camera tracks may lie on the edge of the own car's shadow.
  for (const double start : {8.0, 12.0, 25.0, 40.0}) {
    SampledDriveOptions options = Options(start, false);
    options.num_cameras = 1;
    SampledDrive drive = MakeCarDrive(options);
    for (TrackedFrame& frame : drive.frames)
      for (FeatureObservation& seen : frame.observations)
        if (seen.track % 5 < 3)
          seen.bearing = ExpSo3({0.1 * static_cast<double>(seen.track % 7),
                                 0.1 * static_cast<double>(seen.track % 11), 0}) *
                         Eigen::Vector3d::UnitZ();
    EXPECT_FALSE(Detected(drive).IsStill(1, 1.5)) << start;
  }
}

TEST(StandstillDetector, AGentleStartIsFeltBeforeItIsSeen) {
  SampledDrive drive = MakeRestingDrive(Options(0, false));
  const Timestamp zero = drive.imu.front().time;
  for (ImuSample& sample : drive.imu)
    sample.linear_acceleration.x() += std::clamp(4 * (sample.time - zero - 1.2), 0.0, 1.2);
  EXPECT_TRUE(Detected(drive).IsStill(0.8, 1.1));
  EXPECT_FALSE(Detected(drive).IsStill(1.2, 1.5));
}

TEST(StandstillDetector, TrafficInOneCameraDoesNotMoveACarWhoseWheelsStand) {
  SampledDrive drive = MakeRestingDrive(Options(0, true));
  for (TrackedFrame& frame : drive.frames)
    if (frame.camera == 1)
      for (FeatureObservation& seen : frame.observations)
        seen.bearing = ExpSo3({0, 0.2 * (frame.time - drive.imu.front().time), 0}) * seen.bearing;

  EXPECT_TRUE(Detected(drive).IsStill(1, 1.5));
}

TEST(StandstillDetector, AWheelSensorThatDiedDoesNotStopTheCar) {
  SampledDrive drive = MakeCarDrive(Options(8, true));
  for (WheelSample& sample : drive.wheels) sample.forward_speed = 0;

  EXPECT_FALSE(Detected(drive).IsStill(1, 1.5));
}

TEST(StandstillDetector, WithoutWheelsAndImagesNothingIsCertain) {
  SampledDrive drive = MakeRestingDrive(Options(0, false));
  drive.frames.clear();

  EXPECT_FALSE(Detected(drive).IsStill(1, 1.5));
}

}  // namespace
}  // namespace parkade
