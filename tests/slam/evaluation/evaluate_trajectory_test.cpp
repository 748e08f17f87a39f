#include "slam/evaluation/evaluate_trajectory.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"

namespace parkade {
namespace {

/// 100 m at 10 m/s along a wide curve that climbs, 20 poses per second.
std::vector<TimedPose> Curve() {
  std::vector<TimedPose> poses;
  for (int i = 0; i <= 200; ++i) {
    const double angle = 0.01 * i;  // [rad] on a circle of 50 m
    const Eigen::Vector3d position(50 * std::sin(angle), 50 * (1 - std::cos(angle)), 0.02 * i);
    poses.push_back(
        {Timestamp{1'000'000'000 + 50'000'000LL * i}, {ExpSo3({0, 0, angle}), position}});
  }
  return poses;
}

std::vector<TimedPose> Moved(std::vector<TimedPose> poses, const Rigid3& other_from_world) {
  for (TimedPose& pose : poses) pose.world_from_frame = other_from_world * pose.world_from_frame;
  return poses;
}

TEST(EvaluateTrajectory, TheSameDriveInAnotherWorldHasNoError) {
  const std::vector<TimedPose> truth = Curve();
  const Rigid3 other_from_world{ExpSo3({0.5, -0.2, 2.0}), {30, -20, 5}};

  const TrajectoryEvaluation evaluation = EvaluateTrajectory(truth, Moved(truth, other_from_world));

  EXPECT_EQ(evaluation.num_matched, 201u);
  EXPECT_NEAR(evaluation.path_length, std::hypot(100, 4), 0.01);
  EXPECT_NEAR(evaluation.duration, 10, 1e-9);
  EXPECT_LT(evaluation.rigid.translation.max, 1e-9);
  EXPECT_LT(evaluation.rigid.rotation.max, 1e-6);
  EXPECT_NEAR(evaluation.scale, 1, 1e-9);
  EXPECT_GT(evaluation.yaw_only.translation.rmse, 1)
      << "a tilted world is an error where both have z up";
  const Rigid3 loop = evaluation.rigid.truth_from_estimate * other_from_world;
  EXPECT_LT(loop.translation.norm() + LogSo3(loop.rotation).norm(), 1e-6);
}

TEST(EvaluateTrajectory, AttitudesTellTheRollThatAStraightDriveLeavesOpen) {
  std::vector<TimedPose> truth;
  for (int i = 0; i <= 100; ++i) {
    const double x = static_cast<double>(i);
    truth.push_back(
        {TimestampFromSeconds(0.1 * x), Rigid3{Eigen::Quaterniond::Identity(), {x, 0, 0}}});
  }
  const Rigid3 tilted{ExpSo3({0.02, -0.01, 1.0}), {3, 2, 1}};

  const TrajectoryEvaluation evaluation = EvaluateTrajectory(truth, Moved(truth, tilted));

  EXPECT_LT(evaluation.by_poses.translation.max + evaluation.by_poses.rotation.max, 1e-6);
  EXPECT_NEAR(evaluation.tilt, std::acos((tilted.rotation * Eigen::Vector3d::UnitZ()).z()), 1e-9);
  EXPECT_GT(evaluation.yaw_only.translation.rmse, 0.2);
}

TEST(EvaluateTrajectory, AlternatingOffsetIsExactlyTheRmse) {
  const std::vector<TimedPose> truth = Curve();
  std::vector<TimedPose> estimate = truth;
  estimate.pop_back();
  for (size_t i = 0; i < estimate.size(); ++i)
    estimate[i].world_from_frame.translation.z() += i % 2 == 0 ? 0.1 : -0.1;

  const TrajectoryEvaluation evaluation = EvaluateTrajectory(truth, estimate);

  EXPECT_NEAR(evaluation.rigid.translation.rmse, 0.1, 1e-4);
  EXPECT_NEAR(evaluation.rigid.translation.median, 0.1, 1e-2);
  EXPECT_NEAR(evaluation.drift_percent,
              100 * evaluation.rigid.translation.rmse / evaluation.path_length, 1e-12);
}

TEST(EvaluateTrajectory, RelativeErrorOfAWrongScaleGrowsWithLength) {
  const std::vector<TimedPose> truth = Curve();
  std::vector<TimedPose> estimate = truth;
  for (TimedPose& pose : estimate) pose.world_from_frame.translation *= 1.02;

  const TrajectoryEvaluation evaluation = EvaluateTrajectory(truth, estimate);

  EXPECT_NEAR(evaluation.scale, 1 / 1.02, 1e-9) << "what the estimate must be multiplied with";
  ASSERT_EQ(evaluation.per_length.size(), 4u);
  EXPECT_NEAR(evaluation.per_length[0].translation.rmse, 0.02, 1e-3);
  EXPECT_NEAR(evaluation.per_length[1].translation.rmse, 0.20, 1e-2);
  EXPECT_LT(evaluation.per_length[1].rotation.max, 1e-7);
  EXPECT_NEAR(evaluation.per_second.translation.rmse, 0.20, 1e-2);
}

TEST(EvaluateTrajectory, ConstantYawDriftShowsPerSecond) {
  const std::vector<TimedPose> truth = Curve();
  std::vector<TimedPose> estimate = truth;
  for (size_t i = 0; i < estimate.size(); ++i) {
    const double drift = 0.004 * 0.05 * static_cast<double>(i);  // 0.004 rad/s
    estimate[i].world_from_frame.rotation =
        ExpSo3({0, 0, drift}) * estimate[i].world_from_frame.rotation;
  }

  const TrajectoryEvaluation evaluation = EvaluateTrajectory(truth, estimate);

  EXPECT_NEAR(evaluation.per_second.rotation.rmse, 0.004, 1e-9);
  EXPECT_EQ(evaluation.per_second.count, 181u);
}

TEST(EvaluateTrajectory, TruthIsInterpolatedButNotAcrossHoles) {
  std::vector<TimedPose> truth = Curve();
  std::vector<TimedPose> estimate;
  for (size_t i = 0; i + 1 < truth.size(); i += 2) {
    const Timestamp time{(truth[i].time.ns + truth[i + 1].time.ns) / 2};
    estimate.push_back(
        {time, Interpolate(truth[i].world_from_frame, truth[i + 1].world_from_frame, 0.5)});
  }
  truth.erase(truth.begin() + 50, truth.begin() + 100);  // 2.5 s

  const TrajectoryEvaluation evaluation = EvaluateTrajectory(truth, estimate);

  EXPECT_EQ(evaluation.num_estimates, 100u);
  EXPECT_EQ(evaluation.num_matched, 75u);
  EXPECT_LT(evaluation.rigid.translation.max, 1e-6);
}

TEST(EvaluateTrajectory, StandingStillHasNoDriftInPercent) {
  std::vector<TimedPose> truth;
  for (int i = 0; i < 50; ++i) truth.push_back({Timestamp{100'000'000LL * i}, {}});
  std::vector<TimedPose> estimate = truth;
  for (size_t i = 0; i < estimate.size(); ++i)
    estimate[i].world_from_frame.translation.x() = i % 2 == 0 ? 0.01 : -0.01;

  const TrajectoryEvaluation evaluation = EvaluateTrajectory(truth, estimate);

  EXPECT_NEAR(evaluation.rigid.translation.rmse, 0.01, 1e-6);
  EXPECT_EQ(evaluation.drift_percent, 0);
  EXPECT_EQ(evaluation.scale, 1);
}

TEST(EvaluateTrajectory, NothingInCommonIsAnErrorThatSaysSo) {
  const std::vector<TimedPose> truth = Curve();
  std::vector<TimedPose> estimate = truth;
  for (TimedPose& pose : estimate) pose.time.ns += 1'000'000'000'000;

  try {
    EvaluateTrajectory(truth, estimate);
    FAIL() << "an estimate of another day was evaluated";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
    EXPECT_NE(std::string(error.what()).find("0 of 201"), std::string::npos) << error.what();
  }
  EXPECT_THROW(EvaluateTrajectory({truth.rbegin(), truth.rend()}, truth), Error);
}

TEST(EvaluateTrajectory, TextAndJsonCarryTheNumbers) {
  const std::vector<TimedPose> truth = Curve();
  const TrajectoryEvaluation evaluation = EvaluateTrajectory(truth, truth);

  const nlohmann::json json = ToJson(evaluation);

  EXPECT_EQ(json.at("num_matched"), 201);
  EXPECT_EQ(json.at("rigid").at("translation").at("rmse"), evaluation.rigid.translation.rmse);
  EXPECT_EQ(json.at("per_length").size(), 4u);
  EXPECT_NE(ToText(evaluation).find("201 / 201"), std::string::npos);
}

}  // namespace
}  // namespace parkade
