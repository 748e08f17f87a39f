#include "tests/simulator/sensors.h"

#include <gtest/gtest.h>

#include <map>

#include "core/error.h"
#include "tests/simulator/simulated_rig.h"

namespace parkade::simulator {
namespace {

/// Along x at 3 m/s, turning a little.
Motion Rolling(double duration) {
  return Motion([](double t) { return PoseVector(PoseVector(3 * t, 0, 0, 0.05 * t, 0, 0)); }, duration);
}
Motion Standing(double duration) {
  return Motion([](double) { return PoseVector(PoseVector::Zero()); }, duration);
}

/// Allan deviation of the x gyroscope over clusters of `size` samples.
double AllanDeviation(const std::vector<ImuSample>& samples, size_t size) {
  std::vector<double> means;
  for (size_t i = 0; i + size <= samples.size(); i += size) {
    double sum = 0;
    for (size_t k = i; k < i + size; ++k) sum += samples[k].angular_velocity.x();
    means.push_back(sum / static_cast<double>(size));
  }
  double sum = 0;
  for (size_t i = 1; i < means.size(); ++i) sum += (means[i] - means[i - 1]) * (means[i] - means[i - 1]);
  return std::sqrt(sum / (2 * static_cast<double>(means.size() - 1)));
}

TEST(SimulateImu, WhiteNoiseHasTheDensityOfTheRigAndAveragesOutWithTheRootOfTime) {
  const Rig rig = MakeSimulatedRig({}, 1);
  const auto samples = SimulateImu(Standing(400), rig, {}, 1);

  const double at_10_ms = AllanDeviation(samples, 1), at_1_s = AllanDeviation(samples, 100);
  EXPECT_NEAR(at_10_ms, rig.imu.gyroscope_noise_density * 10, 0.05 * at_10_ms);
  EXPECT_NEAR(at_10_ms / at_1_s, 10, 1.2);  // slope -1/2 over two decades
}

TEST(SimulateImu, WithoutNoiseAStandingImuFeelsGravityOnly) {
  SensorOptions options;
  options.imu_noise = 0;
  const Rig rig = MakeSimulatedRig({}, 1);
  const auto samples = SimulateImu(Standing(1), rig, options, 1);

  ASSERT_EQ(samples.size(), 100u);
  EXPECT_NEAR(samples[50].linear_acceleration.norm(), kGravity, 1e-9);
  EXPECT_NEAR((rig.body_from_imu.rotation * samples[50].linear_acceleration).z(), kGravity, 1e-9);
  EXPECT_NEAR(samples[50].angular_velocity.norm(), 0, 1e-12);
}

TEST(SimulateWheels, SpeedIsOffByTheScaleErrorAndIntegratesToTheWay) {
  SensorOptions options;
  options.wheel_scale_error = 0.01;
  const auto samples =
      SimulateWheels(Motion([](double t) { return PoseVector(PoseVector(3 * t, 0, 0, 0, 0, 0)); }, 60), options, 5);

  double way = 0;
  for (size_t i = 1; i < samples.size(); ++i) way += samples[i].forward_speed * (samples[i].time - samples[i - 1].time);
  EXPECT_NEAR(way / (3 * (samples.back().time - samples.front().time)), 1.01, 3e-4);
}

TEST(SimulateWheels, StandingWheelsGiveExactlyZero) {
  for (const WheelSample& sample : SimulateWheels(Standing(2), {}, 5)) {
    EXPECT_EQ(sample.forward_speed, 0);
    EXPECT_EQ(sample.yaw_rate, 0);
  }
}

TEST(SimulateGnss, ErrorsHaveTheSizeThatTheFixesState) {
  const Rig rig = MakeSimulatedRig({}, 1);
  for (const char* kind : {"standard", "rtk"}) {
    SensorOptions options;
    options.gnss = kind;
    const Motion motion = Rolling(3000);
    const auto fixes = SimulateGnss(motion, rig, SimulatedDatum(), options, 9);
    Eigen::Vector3d sum_squares = Eigen::Vector3d::Zero();
    for (const GnssFix& fix : fixes) {
      const Eigen::Vector3d antenna = motion.WorldFromBody(fix.time - DriveEpoch(9)) * *rig.vehicle->antenna_in_body;
      const Eigen::Vector3d error =
          SiteFromGeodetic(SimulatedDatum(), fix.latitude_deg, fix.longitude_deg, fix.altitude) - antenna;
      sum_squares += error.cwiseQuotient(fix.sigma_enu).cwiseAbs2();
    }
    const Eigen::Vector3d ratio = (sum_squares / static_cast<double>(fixes.size())).cwiseSqrt();
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(ratio[axis], 1, 0.3) << kind << " axis " << axis;
  }
}

TEST(SimulateGnss, NoneGivesNone) {
  SensorOptions options;
  options.gnss = "none";
  EXPECT_TRUE(SimulateGnss(Standing(5), MakeSimulatedRig({}, 1), SimulatedDatum(), options, 1).empty());
}

TEST(ScheduleFrames, CamerasKeepTheirRateButNeverFireTogether) {
  const auto frames = ScheduleFrames(Standing(60), 4, {}, 0.1, 2);

  std::map<size_t, std::vector<Timestamp>> times;
  for (size_t i = 0; i < frames.size(); ++i) {
    times[frames[i].camera].push_back(frames[i].time);
    if (i > 0) {
      EXPECT_GE(frames[i].time, frames[i - 1].time);
    }
  }
  ASSERT_EQ(times.size(), 4u);
  for (const auto& [camera, stamps] : times) {
    EXPECT_NEAR(static_cast<double>(stamps.size()), 598, 2);
    for (size_t i = 1; i < stamps.size(); ++i) EXPECT_NEAR(stamps[i] - stamps[i - 1], 0.1, 0.0049);
    if (camera > 0) {
      EXPECT_GT(std::abs(std::remainder(stamps[0] - times[0][0], 0.1)), 1e-3);
    }
  }
}

TEST(ScheduleFrames, LosesTheShareOfPicturesAskedFor) {
  CameraClockOptions options;
  options.drop_probability = 0.2;
  const auto all = ScheduleFrames(Standing(200), 1, {}, 0.1, 2),
             some = ScheduleFrames(Standing(200), 1, options, 0.1, 2);
  EXPECT_NEAR(static_cast<double>(some.size()) / static_cast<double>(all.size()), 0.8, 0.04);
}

TEST(SensorOptions, AnUnknownKindOfGnssIsRefused) {
  SensorOptions options;
  options.gnss = "galileo";
  EXPECT_THROW(options.Validate(), Error);
}

}  // namespace
}  // namespace parkade::simulator
