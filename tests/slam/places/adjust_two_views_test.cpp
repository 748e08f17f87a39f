#include "slam/places/adjust_two_views.h"

#include <gtest/gtest.h>

#include <random>

namespace parkade {
namespace {

constexpr double kSigma = 0.002;  // [rad] of rays

Rigid3 Truth() {
  return {ExpSo3({0.02, -0.01, 0.2}), Eigen::Vector3d(0.8, 0.6, 0.05).normalized()};
}

/// Points 4 to 20 m ahead of two cameras that lie `baseline` apart, with noise.
std::vector<RayPair> SeePoints(double baseline, int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal(0, kSigma);
  const Rigid3 a_from_b{Truth().rotation, baseline * Truth().translation};
  std::vector<RayPair> pairs;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d point(12 + 8 * uniform(random), 10 * uniform(random),
                                3 * uniform(random));
    const auto noisy = [&](const Eigen::Vector3d& ray) {
      return (ray.normalized() + Eigen::Vector3d(normal(random), normal(random), normal(random)))
          .normalized();
    };
    const Eigen::Vector3d in_a = noisy(point), in_b = noisy(a_from_b.Inverse() * point);
    pairs.push_back({in_a, in_b, kSigma, kSigma});
  }
  return pairs;
}

TEST(AdjustTwoViews, MovesARoughPoseToTheTruthAndSaysHowWellItIsKnown) {
  double rotation = 0, direction = 0;
  constexpr int kTrials = 40;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    Rigid3 pose = Truth();
    pose.rotation = pose.rotation * ExpSo3({0.01, -0.02, 0.015});
    pose.translation = (pose.translation + Eigen::Vector3d(-0.1, 0.1, 0.05)).normalized();

    const AdjustedTwoViews adjusted = AdjustTwoViews(SeePoints(1.5, 80, seed), pose);

    const Eigen::Vector3d turn = LogSo3(Truth().rotation.conjugate() * pose.rotation);
    rotation += turn.dot(adjusted.rotation_covariance.inverse() * turn) / 3 / kTrials;
    direction += std::pow(std::acos(std::min(1.0, pose.translation.dot(Truth().translation))), 2) /
                 std::pow(adjusted.direction_sigma, 2) / kTrials;
  }
  EXPECT_GT(rotation, 0.6) << "squared error over variance, per number: 1 is right";
  EXPECT_LT(rotation, 1.6);
  EXPECT_LT(direction, 1.6) << "the worst of two ways: less than 2";
  EXPECT_GT(direction, 0.4);
}

TEST(AdjustTwoViews, WithoutABaselineTheDirectionIsUnknownAndTheRotationIsNot) {
  Rigid3 pose = Truth();
  const AdjustedTwoViews adjusted = AdjustTwoViews(SeePoints(0.002, 80, 1), pose);
  EXPECT_GT(adjusted.direction_sigma, 0.3);
  EXPECT_LT(pose.rotation.angularDistance(Truth().rotation), 0.003);
}

TEST(AdjustTwoViews, TooFewRaysLeaveItAsItIs) {
  Rigid3 pose = Truth();
  const AdjustedTwoViews adjusted = AdjustTwoViews(SeePoints(1, 5, 1), pose);
  EXPECT_EQ(pose.translation, Truth().translation);
  EXPECT_EQ(adjusted.direction_sigma, 1);
}

}  // namespace
}  // namespace parkade
