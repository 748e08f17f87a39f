#include "slam/factors/imu_preintegration.h"

#include <gtest/gtest.h>

#include <random>

#include "slam/factors/image_pose.h"
#include "tests/support/synthetic_motion.h"

namespace parkade {
namespace {

Timestamp At(double seconds) { return TimestampFromSeconds(100 + seconds); }

ImuSample SampleOf(const BodyMotion& motion, double seconds) {
  return {At(seconds), motion.angular_velocity,
          motion.world_from_body.rotation.conjugate() * (motion.acceleration - kGravityInOdom)};
}

MotionState StateOf(const BodyMotion& motion, double seconds) {
  MotionState state;
  state.time = At(seconds);
  state.odom_from_imu = motion.world_from_body;
  state.velocity_in_odom = motion.velocity;
  return state;
}

std::vector<ImuSample> SamplesOf(const MotionFunction& motion, double begin, double end,
                                 double rate) {
  std::vector<ImuSample> samples;
  const int steps = static_cast<int>(std::lround((end - begin) * rate));
  for (int k = 0; k <= steps; ++k) {
    const double t = begin + (end - begin) * k / steps;
    samples.push_back(SampleOf(motion(t), t));
  }
  return samples;
}

TEST(ImuPreintegration, PropagatesAnExactMotionToTheIntegratorsOrder) {
  const MotionFunction motion = FlightMotion();
  double last_error = 0;
  for (const double rate : {50.0, 100.0}) {
    const MotionState end =
        Propagate(StateOf(motion(1), 1), Integrate(SamplesOf(motion, 1, 2, rate), {}));
    const BodyMotion truth = motion(2);
    const double error = (end.odom_from_imu.translation - truth.world_from_body.translation).norm();

    EXPECT_LT(error, 2e-3)
        << rate;  // the rest is that samples, not the motion, are linear in between
    EXPECT_LT(end.odom_from_imu.rotation.angularDistance(truth.world_from_body.rotation), 1e-3)
        << rate;
    EXPECT_LT((end.velocity_in_odom - truth.velocity).norm(), 4e-3) << rate;
    if (last_error > 0) {
      EXPECT_LT(error, 0.3 * last_error);
    }
    last_error = error;
  }
}

TEST(ImuPreintegration, ConingCostsNothing) {
  // A fast wobble, constant within a step in neither axis: exact by a thousand small steps.
  const auto rate_at = [](double t) { return Eigen::Vector3d(2 + 20 * t, 3 - 30 * t, 1 + 10 * t); };
  constexpr double kStep = 0.01;
  Eigen::Quaterniond exact = Eigen::Quaterniond::Identity();
  for (int k = 0; k < 1000; ++k)
    exact = exact * ExpSo3(rate_at((k + 0.5) * kStep / 1000) * (kStep / 1000));

  const Eigen::Quaterniond one_step = ExpSo3(RotationOverStep(rate_at(0), rate_at(kStep), kStep));

  EXPECT_LT(one_step.angularDistance(exact), 1e-7);
}

TEST(ImuPreintegration, PropagatingBackUndoesPropagating) {
  const MotionFunction motion = FlightMotion();
  const MotionState begin = StateOf(motion(3), 3);
  const MotionIncrement increment = Integrate(SamplesOf(motion, 3, 4, 100), {});

  const MotionState back = PropagateBack(Propagate(begin, increment), increment);

  EXPECT_LT((back.odom_from_imu.translation - begin.odom_from_imu.translation).norm(), 1e-12);
  EXPECT_LT(back.odom_from_imu.rotation.angularDistance(begin.odom_from_imu.rotation), 1e-7);
  EXPECT_LT((back.velocity_in_odom - begin.velocity_in_odom).norm(), 1e-12);
}

TEST(ImuPreintegration, FirstOrderBiasCorrectionAgreesWithIntegratingAgain) {
  const std::vector<ImuSample> samples = SamplesOf(FlightMotion(), 0, 0.2, 200);
  const ImuBias bias{{2e-3, -1e-3, 3e-3}, {0.02, 0.05, -0.03}};
  ImuPreintegration imu(samples, {}, {});
  const MotionIncrement corrected = imu.Corrected(bias);

  imu.Reintegrate(bias);

  const MotionIncrement& exact = imu.increment();
  EXPECT_LT(corrected.rotation.angularDistance(exact.rotation), 2e-7);
  EXPECT_LT((corrected.velocity - exact.velocity).norm(), 1e-5);
  EXPECT_LT((corrected.position - exact.position).norm(), 1e-6);
}

TEST(ImuPreintegration, CovarianceIsThatOfManyNoisyRuns) {
  ImuCalibration calibration;
  calibration.update_rate = 200;
  const std::vector<ImuSample> exact = SamplesOf(FlightMotion(), 0, 0.25, 200);
  const ImuPreintegration clean(exact, {}, calibration);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const double root_rate = std::sqrt(200.0);
  double nees = 0;
  constexpr int kRuns = 500;
  const auto information = clean.covariance().inverse().eval();
  for (int run = 0; run < kRuns; ++run) {
    // White noise over a step is the mean of its two ends: keep its variance.
    std::vector<ImuSample> noisy = exact;
    MotionIncrement increment;
    for (size_t k = 1; k < exact.size(); ++k) {
      ImuSample from = exact[k - 1], to = exact[k];
      for (int axis = 0; axis < 3; ++axis) {
        const double gyroscope = normal(random) * calibration.gyroscope_noise_density * root_rate;
        const double accelerometer =
            normal(random) * calibration.accelerometer_noise_density * root_rate;
        from.angular_velocity[axis] += gyroscope;
        to.angular_velocity[axis] += gyroscope;
        from.linear_acceleration[axis] += accelerometer;
        to.linear_acceleration[axis] += accelerometer;
      }
      Advance(increment, from, to, {});
    }
    Eigen::Matrix<double, 9, 1> error;
    error << LogSo3(clean.increment().rotation.conjugate() * increment.rotation),
        increment.velocity - clean.increment().velocity,
        increment.position - clean.increment().position;
    nees += error.dot(information * error) / 9 / kRuns;
  }

  EXPECT_NEAR(nees, 1, 0.1);  // the mean of 4500 squares of unit normals has a deviation of 0.02
}

TEST(NodeInterpolation, FollowsTheTrueMotionBetweenNodesThatAreRight) {
  const MotionFunction motion = CarMotion(20);
  for (const double begin : {4.0, 9.0, 16.0}) {
    const std::vector<ImuSample> samples = SamplesOf(motion, begin, begin + 0.2, 200);
    const Rigid3 first = motion(begin).world_from_body,
                 second = motion(begin + 0.2).world_from_body;
    const MotionIncrement whole = Integrate(samples, {});
    for (const int k : {1, 13, 20, 33}) {
      const MotionIncrement part =
          Integrate(std::span(samples).first(static_cast<size_t>(k) + 1), {});

      const Rigid3 pose = MakeNodeInterpolation(part, whole, first.rotation).At(first, second);

      const Rigid3 truth = motion(begin + 0.005 * k).world_from_body;
      EXPECT_LT((pose.translation - truth.translation).norm(), 1e-5);
      EXPECT_LT(pose.rotation.angularDistance(truth.rotation), 1e-5);
    }
  }
}

TEST(NodeInterpolation, IsHardlyMovedByWrongBiases) {
  const MotionFunction motion = CarMotion(20);
  const std::vector<ImuSample> samples = SamplesOf(motion, 16, 16.2, 200);
  const Rigid3 first = motion(16).world_from_body, second = motion(16.2).world_from_body;
  const ImuBias wrong{{0.05, -0.05, 0.05}, {0.2, 0.2, -0.2}};
  const MotionIncrement part = Integrate(std::span(samples).first(21), wrong),
                        whole = Integrate(samples, wrong);

  const Rigid3 pose = MakeNodeInterpolation(part, whole, first.rotation).At(first, second);

  const Rigid3 truth = motion(16.1).world_from_body;
  EXPECT_LT((pose.translation - truth.translation).norm(), 2.5e-3);  // da t^2 / 8
  EXPECT_LT(pose.rotation.angularDistance(truth.rotation), 2e-4);
}

}  // namespace
}  // namespace parkade
