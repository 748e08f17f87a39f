#include "tests/bench/odometry/pose_consistency.h"

#include <gtest/gtest.h>

#include <random>

namespace parkade {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

const Rigid3 kBodyFromImu{ExpSo3({0.02, -0.03, 0.01}), {0.6, 0.1, 0.5}};

/// What an estimate was told to be off by.
struct Noise {
  double rotation = 2e-3, position = 0.05;  ///< standard deviations at the end
  double believed = 1;                      ///< times which the covariance is
};

/// A curve of 20 s in a world that is turned and moved against odom. The first state is exact, the
/// others off by draws from a full covariance.
std::vector<PoseConsistency> Draw(const Noise& noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Rigid3 odom_from_world{ExpSo3({0, 0, 2.1}), {10, -7, 2}};
  std::vector<TimedPose> truth;
  std::vector<TrajectoryState> states;
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.1 * i;
    const Rigid3 world_from_body{ExpSo3({0.02 * std::sin(t), 0.03 * std::cos(t), 0.2 * t}),
                                 {t, 0.1 * t * t, 0.2 * t}};
    truth.push_back({Timestamp{1'000'000'000} + t, world_from_body});
    if (i % 10 != 5) continue;
    TrajectoryState state;
    state.time = truth.back().time;
    Matrix6 root = Matrix6::Identity();
    root.bottomLeftCorner<3, 3>().setConstant(0.3);
    const double growth = i == 5 ? 1e-4 : t / 20;
    Vector6 sigma;
    sigma << Eigen::Vector3d::Constant(noise.rotation * growth),
        Eigen::Vector3d::Constant(noise.position * growth);
    root = sigma.asDiagonal() * root;
    Vector6 draw;
    for (double& value : draw) value = normal(random);
    const Vector6 error = root * draw;
    const Rigid3 expected = odom_from_world * world_from_body;
    state.world_from_body = {(expected.rotation * ExpSo3(-error.head<3>())).normalized(),
                             expected.translation - error.tail<3>()};
    state.covariance = noise.believed * noise.believed * root * root.transpose();
    states.push_back(state);
  }
  return MeasureConsistency(Trajectory(states), truth, kBodyFromImu, {0.5, 1});
}

double MeanAtEnd(const Noise& noise, int num_runs) {
  double sum = 0;
  for (int run = 0; run < num_runs; ++run)
    sum += Draw(noise, static_cast<unsigned>(run)).back().pose / num_runs;
  return sum;
}

TEST(PoseConsistency, HonestErrorsScoreOneWithinTheirBounds) {
  const ConfidenceBounds bounds = BoundsOfMean(200, 6);

  const double mean = MeanAtEnd({}, 200);

  EXPECT_GT(mean, bounds.low);
  EXPECT_LT(mean, bounds.high);
}

TEST(PoseConsistency, BelievingInHalfTheErrorScoresFour) {
  EXPECT_NEAR(MeanAtEnd({.believed = 0.5}, 200), 4, 0.6);
}

TEST(PoseConsistency, NamesSizesOfErrorsAndTimes) {
  const std::vector<PoseConsistency> measured = Draw({.rotation = 0, .position = 0}, 1);

  ASSERT_EQ(measured.size(), 0u) << "without a covariance there is nothing to compare with";
  const std::vector<PoseConsistency> noisy = Draw({}, 1);
  ASSERT_EQ(noisy.size(), 2u);
  EXPECT_NEAR(noisy[0].time, 9.5, 0.6);
  EXPECT_NEAR(noisy[1].time, 19, 1e-6);
  EXPECT_LT(noisy[1].position_error, 0.3);
  EXPECT_GT(noisy[1].position_error, 1e-3);
}

TEST(PoseConsistency, BoundsAreThoseOfTheChiSquareTables) {
  const ConfidenceBounds one = BoundsOfMean(1, 6), many = BoundsOfMean(30, 6);
  EXPECT_NEAR(6 * one.low, 1.237, 0.05);  // the approximation is weakest for few
  EXPECT_NEAR(6 * one.high, 14.449, 0.05);
  EXPECT_NEAR(180 * many.low, 144.74, 0.5);
  EXPECT_NEAR(180 * many.high, 219.04, 0.5);
}

}  // namespace
}  // namespace parkade
