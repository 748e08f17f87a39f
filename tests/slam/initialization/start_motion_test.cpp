#include "slam/initialization/start_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "slam/factors/triangulate.h"
#include "slam/initialization/start_problem.h"
#include "tests/support/sampled_drive.h"

namespace parkade {
namespace {

struct Buffers {
  ImuBuffer imu;
  WheelBuffer wheels;
};

Buffers BuffersOf(const SampledDrive& drive) {
  Buffers buffers;
  for (const ImuSample& sample : drive.imu) buffers.imu.Add(sample);
  for (const WheelSample& sample : drive.wheels) buffers.wheels.Add(sample);
  return buffers;
}

double TiltError(const SampledDrive& drive, const Eigen::Quaterniond& odom_from_imu) {
  const Eigen::Quaterniond truth =
      drive.truth.front().world_from_frame.rotation * drive.rig.body_from_imu.rotation;
  const Eigen::Vector3d up = odom_from_imu.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d true_up = truth.conjugate() * Eigen::Vector3d::UnitZ();
  return std::acos(std::min(1.0, up.dot(true_up)));
}

/// Some seconds of a road without wheels, at 10 Hz.
SampledDriveOptions RoadOptions(int number, double duration, int num_cameras) {
  SampledDriveOptions options;
  options.seed = static_cast<std::uint32_t>(100 + number);
  options.duration = duration;
  options.camera_rate = 10;
  options.num_cameras = num_cameras;
  options.has_wheels = false;
  options.points_per_meter = 6;
  options.tracks = 150;
  return options;
}

/// From all that was recorded.
auto StartOf(const SampledDrive& drive, const ImuBuffer& imu) {
  return StartFromImages(imu, drive.frames, drive.rig,
                         EstimateGyroscopeBias(drive.frames, imu, drive.rig).value(),
                         drive.imu.front().time, imu.back().time);
}

TEST(EstimateGyroscopeBias, FindsALargeBiasInFlight) {
  SampledDriveOptions options;
  options.duration = 2;
  options.gyroscope_bias = 0.06;
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) {
    options.seed = seed;
    SampledDriveOptions without = options;
    without.gyroscope_bias = 0;  // the same noise without bias: the difference is the bias
    const SampledDrive flight = MakeFlight(options);
    const Eigen::Vector3d bias =
        flight.imu.front().angular_velocity - MakeFlight(without).imu.front().angular_velocity;
    ASSERT_GT(bias.norm(), 0.02);

    const auto estimate = EstimateGyroscopeBias(flight.frames, BuffersOf(flight).imu, flight.rig);

    ASSERT_TRUE(estimate.has_value());
    EXPECT_LT((estimate->bias - bias).norm(), std::max(0.006, 4 * estimate->sigma)) << seed;
  }
}

TEST(StartFromImages, FindsVelocityAndGravityOfAFlight) {
  int num_found = 0;
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) {
    SampledDriveOptions options;
    options.seed = seed;
    options.duration = 2;
    const SampledDrive flight = MakeFlight(options);
    const ImuBuffer imu = BuffersOf(flight).imu;
    const auto bias = EstimateGyroscopeBias(flight.frames, imu, flight.rig);
    ASSERT_TRUE(bias);

    const auto start = StartFromImages(imu, flight.frames, flight.rig, *bias,
                                       flight.imu.front().time, imu.back().time);

    if (!start) continue;
    ++num_found;
    const double speed = FlightMotion()(0).velocity.norm();
    EXPECT_LT(TiltError(flight, start->state.odom_from_imu.rotation), 0.05) << seed;
    EXPECT_NEAR(start->state.velocity_in_odom.norm(), speed, 0.2 * speed) << seed;
  }
  EXPECT_GE(num_found, 3);
}

TEST(StartFromImages, StereoStartsWithinASecondAtAnySpeedInAnyBend) {
  int num_found = 0;
  for (int k = 0; k < 40; ++k) {
    const double speed = 15 + 20.0 * k / 39, yaw_rate = (k % 2 == 0 ? 1 : -1) * (k % 8) / 7.0;
    SampledDrive drive = MakeBendDrive(RoadOptions(k, 1.1, 2), speed, yaw_rate);
    drive.rig.vehicle.reset();  // or the height of the cameras would tell the scale
    const ImuBuffer imu = BuffersOf(drive).imu;

    const auto start = StartOf(drive, imu);

    if (!start) continue;
    ++num_found;
    EXPECT_NEAR(start->state.velocity_in_odom.norm(), speed, 0.03 * speed) << yaw_rate << " rad/s";
    EXPECT_LT(TiltError(drive, start->state.odom_from_imu.rotation), 0.05)
        << speed << " m/s, " << yaw_rate << " rad/s";
  }
  EXPECT_EQ(num_found, 40);
}

TEST(StartFromImages, OneCameraAtAKnownHeightStartsOnAStraightRoadAndInBends) {
  constexpr int kDrives = 40;
  int num_right = 0, num_within_sigmas = 0;
  for (int k = 0; k < kDrives; ++k) {
    const double speed = 15 + 20.0 * k / (kDrives - 1);
    const double yaw_rate = (k % 2 == 0 ? 1 : -1) * (k % 4) / 3.0;
    const SampledDrive drive = MakeBendDrive(RoadOptions(k, 2.5, 1), speed, yaw_rate);
    const ImuBuffer imu = BuffersOf(drive).imu;

    const auto start = StartOf(drive, imu);

    if (!start) continue;
    const double error = std::abs(start->state.velocity_in_odom.norm() - speed);
    if (error < 0.06 * speed) ++num_right;
    if (error < 2 * start->uncertainty.velocity) ++num_within_sigmas;
  }
  EXPECT_GE(num_right, 37);
  EXPECT_GE(num_within_sigmas, 37);
}

/// Points that one camera saw, each `depth` [m] below it.
StartProblem ProblemOverGround(const std::vector<double>& depths) {
  StartProblem problem;
  problem.images.resize(1);
  problem.images[0].rotation.setIdentity();
  for (const double depth : depths) {
    StartTrack& track = problem.tracks.emplace_back();
    track.observations.resize(1);
    track.ray = Eigen::Vector3d(4, 1, -depth).normalized();
    track.inverse_distance = 1 / Eigen::Vector3d(4, 1, -depth).norm();
    track.inverse_distance_sigma = 0.01 * track.inverse_distance;
  }
  return problem;
}

Rig RigAtHeight(double height) {
  Rig rig;
  rig.vehicle = VehicleCalibration{};
  rig.cameras.resize(1);
  rig.cameras[0].body_from_camera.translation.z() = height;
  return rig;
}

TEST(MeasureGroundScale, VergesAboveTheRoadHardlyPullIt) {
  const StartProblem problem =
      ProblemOverGround({1.5, 1.51, 1.49, 1.5, 1.52, 1.5, 1.31, 1.32, 1.3, 1.31, 1.33});

  const auto scale = MeasureGroundScale(problem, RigAtHeight(1.5));

  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->log_scale, 0, 0.02);
  EXPECT_EQ(scale->num_points, 11);
}

TEST(MeasureGroundScale, TellsByHowMuchTheWorldIsTooSmall) {
  const StartProblem problem = ProblemOverGround({0.75, 0.76, 0.75, 0.74, 0.75, 0.75});

  const auto scale = MeasureGroundScale(problem, RigAtHeight(1.5));

  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->log_scale, std::log(2), 0.01);
}

TEST(CollectStartProblem, KeepsLowTracksOfTwoImagesWhereTheGroundIsKnown) {
  SampledDriveOptions options;
  options.duration = 2;
  options.camera_rate = 10;
  options.num_cameras = 1;
  SampledDrive drive = MakeBendDrive(options, 30, 0);
  const ImuBuffer imu = BuffersOf(drive).imu;
  const auto num_brief = [&] {
    const StartProblem problem = CollectStartProblem(imu, drive.frames, drive.rig, {},
                                                     drive.imu.front().time, drive.imu.back().time);
    return std::count_if(problem.tracks.begin(), problem.tracks.end(),
                         [](const StartTrack& track) { return track.observations.size() == 2; });
  };

  EXPECT_GT(num_brief(), 0);
  drive.rig.vehicle.reset();
  EXPECT_EQ(num_brief(), 0);
}

TEST(StartFromImages, RefusesACarAtConstantSpeedWhoseScaleNothingTells) {
  SampledDriveOptions options;
  options.start = 11;
  options.duration = 1;
  options.num_cameras = 1;
  const SampledDrive drive = MakeCarDrive(options);
  const ImuBuffer imu = BuffersOf(drive).imu;

  EXPECT_FALSE(
      StartFromImages(imu, drive.frames, drive.rig, {}, drive.imu.front().time, imu.back().time));
}

/// 1 s straight on at constant speed: nothing but the ground tells scale to cameras that do not see
/// the same.
std::optional<StartEstimate> StartAtConstantSpeed(std::uint32_t seed, bool knows_ground,
                                                  double& speed) {
  SampledDriveOptions options;
  options.seed = seed;
  options.start = 8;
  options.duration = 1.2;
  SampledDrive drive = MakeCarDrive(options);
  if (!knows_ground) drive.rig.vehicle.reset();
  speed = CarMotion(20)(options.start).velocity.norm();
  const ImuBuffer imu = BuffersOf(drive).imu;
  const auto bias = EstimateGyroscopeBias(drive.frames, imu, drive.rig);
  EXPECT_TRUE(bias);
  return StartFromImages(imu, drive.frames, drive.rig, *bias, drive.imu.front().time,
                         imu.back().time);
}

TEST(StartFromImages, TakesTheScaleFromTheHeightOfTheCameras) {
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) {
    double speed = 0;

    const auto start = StartAtConstantSpeed(seed, /*knows_ground=*/true, speed);

    ASSERT_TRUE(start) << seed;
    EXPECT_NEAR(start->state.velocity_in_odom.norm(), speed, 0.12 * speed) << seed;
  }
}

TEST(StartFromImages, WaitsWhereNeitherGroundNorAccelerationTellScale) {
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) {
    double speed = 0;
    EXPECT_FALSE(StartAtConstantSpeed(seed, /*knows_ground=*/false, speed)) << seed;
  }
}

TEST(StartFromWheels, FindsTiltAndVelocityWhileBrakingInATurn) {
  SampledDriveOptions options;
  options.start = 14.5;
  options.duration = 2;
  const SampledDrive drive = MakeCarDrive(options);
  const Buffers buffers = BuffersOf(drive);

  const auto start =
      StartFromWheels(buffers.imu, buffers.wheels, drive.rig, {Eigen::Vector3d::Zero(), 0.01},
                      drive.imu.front().time, drive.imu.front().time + 1.0);

  ASSERT_TRUE(start);
  EXPECT_LT(TiltError(drive, start->state.odom_from_imu.rotation), 0.03);
  EXPECT_NEAR(start->state.velocity_in_odom.norm(), CarMotion(20)(14.5).velocity.norm(), 0.15);
}

TEST(StartFromStandstill, FindsTiltAndBias) {
  SampledDriveOptions options;
  options.duration = 2;
  const SampledDrive drive = MakeRestingDrive(options);
  const ImuBuffer imu = BuffersOf(drive).imu;

  const auto start =
      StartFromStandstill(imu, drive.rig.imu, drive.imu.front().time, drive.imu.front().time + 1.0);

  ASSERT_TRUE(start);
  EXPECT_LT(TiltError(drive, start->state.odom_from_imu.rotation), 0.02);
}

TEST(LeveledRotation, TurnsDownDownAndForwardAhead) {
  const Eigen::Vector3d gravity_in_imu = Eigen::Vector3d(1, 2, -9).normalized() * 9.81;

  const Eigen::Quaterniond rotation = LeveledRotation(gravity_in_imu);

  EXPECT_LT((rotation * gravity_in_imu - kGravityInOdom).norm(), 1e-9);
  const Eigen::Vector3d forward = rotation * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(forward.y(), 0, 1e-12);
  EXPECT_GT(forward.x(), 0);
}

ObservationRay RayTo(const Eigen::Vector3d& origin, const Eigen::Vector3d& point) {
  return {origin, (point - origin).normalized(), 1e-3};
}

TEST(Triangulate, FindsThePointWhereRaysMeet) {
  const Eigen::Vector3d point(2, 3, 10);
  const std::vector<ObservationRay> rays{RayTo({0, 0, 0}, point), RayTo({0.5, 0, 0}, point),
                                         RayTo({1, 0.2, 0}, point)};

  const auto found = Triangulate(rays, 5, 0.3);

  ASSERT_TRUE(found);
  EXPECT_NEAR(1 / found->inverse_distance, point.norm(), 1e-6);
}

TEST(Triangulate, RaysWithoutParallaxMeetAtInfinity) {
  const Eigen::Vector3d point(0, 0, 1e5);
  const std::vector<ObservationRay> rays{RayTo({0, 0, 0}, point), RayTo({1, 0, 0}, point)};

  const auto found = Triangulate(rays, 5, 0.3);

  ASSERT_TRUE(found);
  EXPECT_EQ(found->inverse_distance, 0);
}

TEST(Triangulate, RefusesRaysThatContradictEachOther) {
  const std::vector<ObservationRay> skew{RayTo({0, 0, 0}, {0, 0, 5}), RayTo({1, 0, 0}, {0, 0, 5}),
                                         RayTo({0, 1, 0}, {0.5, 0, 5})};
  const std::vector<ObservationRay> behind{RayTo({0, 0, 0}, {0, 0, 5}),
                                           RayTo({1, 0, 0}, {2, 0, 5})};

  EXPECT_FALSE(Triangulate(skew, 5, 0.3));
  EXPECT_FALSE(Triangulate(behind, 5, 0.3));
}

}  // namespace
}  // namespace parkade
