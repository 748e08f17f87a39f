#include "slam/refinement/marginal_covariance.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <random>

#include "slam/factors/imu_sensitivity.h"
#include "slam/factors/landmark_parameters.h"
#include "slam/factors/linearize_block.h"
#include "slam/factors/measurement_model.h"

namespace parkade {
namespace {

/// r = A [x_1; x_2; ...] - b.
class LinearCost final : public ceres::CostFunction {
 public:
  LinearCost(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const std::vector<int>& sizes)
      : a_(a), b_(b) {
    set_num_residuals(static_cast<int>(a.rows()));
    *mutable_parameter_block_sizes() = sizes;
  }
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd> residual(residuals, a_.rows());
    residual = -b_;
    Eigen::Index column = 0;
    for (size_t i = 0; i < parameter_block_sizes().size(); ++i) {
      const Eigen::Index size = parameter_block_sizes()[i];
      const auto part = a_.middleCols(column, size);
      residual += part * Eigen::Map<const Eigen::VectorXd>(parameters[i], size);
      if (jacobians && jacobians[i])
        Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
            jacobians[i], a_.rows(), size) = part;
      column += size;
    }
    return true;
  }

 private:
  Eigen::MatrixXd a_;
  Eigen::VectorXd b_;
};

/// Four states of two in a chain, each pair of neighbors with a landmark that both see three times.
class MarginalCovarianceTest : public testing::Test {
 protected:
  static constexpr int kStates = 4, kSights = 3;

  MarginalCovarianceTest() {
    for (int i = 0; i < kStates; ++i) problem_.AddParameterBlock(states_[i].data(), 2);
    Add({0}, 2, nullptr);
    for (int i = 0; i + 1 < kStates; ++i) Add({i, i + 1}, 3, nullptr);
    for (int i = 0; i + 1 < kStates; ++i)
      for (int k = 0; k < 2 * kSights; ++k) Add({i + k % 2}, 2, landmarks_[i].data());
    ceres::Solver::Summary summary;
    ceres::Solve({}, &problem_, &summary);
  }

  void Add(const std::vector<int>& states, int rows, double* landmark) {
    std::vector<double*> blocks;
    std::vector<int> sizes;
    for (const int state : states)
      blocks.push_back(states_[static_cast<size_t>(state)].data()), sizes.push_back(2);
    if (landmark) blocks.push_back(landmark), sizes.push_back(kLandmarkSize);
    const int columns = 2 * static_cast<int>(states.size()) + (landmark ? kLandmarkSize : 0);
    const Eigen::MatrixXd a =
        Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return noise_(random_); });
    const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(rows, [&] { return noise_(random_); });
    problem_.AddResidualBlock(new LinearCost(a, b, sizes), nullptr, blocks);
    rows_.push_back({a, b, states, landmark});
  }

  struct Rows {
    Eigen::MatrixXd a;
    Eigen::VectorXd b;
    std::vector<int> states;
    double* landmark;
  };

  /// All Jacobian columns, states first; `landmark` null: rows of no landmark.
  Eigen::MatrixXd Stacked(const double* landmark, Eigen::VectorXd& residual) const {
    Eigen::MatrixXd stacked(0, 2 * kStates + kLandmarkSize);
    residual.resize(0);
    for (const Rows& rows : rows_) {
      if (rows.landmark != landmark) continue;
      Eigen::MatrixXd part = Eigen::MatrixXd::Zero(rows.a.rows(), stacked.cols());
      Eigen::VectorXd error = -rows.b;
      for (size_t i = 0; i < rows.states.size(); ++i) {
        const auto block = rows.a.middleCols(2 * static_cast<Eigen::Index>(i), 2);
        part.middleCols(2 * rows.states[i], 2) = block;
        error += block * Eigen::Map<const Eigen::Vector2d>(
                             states_[static_cast<size_t>(rows.states[i])].data());
      }
      if (landmark) {
        part.rightCols(kLandmarkSize) = rows.a.rightCols(kLandmarkSize);
        error += rows.a.rightCols(kLandmarkSize) * Eigen::Map<const Eigen::Vector3d>(landmark);
      }
      stacked.conservativeResize(stacked.rows() + part.rows(), Eigen::NoChange);
      stacked.bottomRows(part.rows()) = part;
      residual.conservativeResize(residual.size() + error.size());
      residual.tail(error.size()) = error;
    }
    return stacked;
  }

  std::mt19937 random_{4};
  std::normal_distribution<double> noise_;
  std::array<std::array<double, 2>, kStates> states_{};
  std::array<std::array<double, kLandmarkSize>, kStates> landmarks_{};
  ceres::Problem problem_;
  std::vector<Rows> rows_;
};

TEST_F(MarginalCovarianceTest, IsTheSandwichOfDenseMatrices) {
  constexpr int kSize = 2 * kStates;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(kSize, kSize), scores = information;
  Eigen::VectorXd residual;
  const Eigen::MatrixXd of_states = Stacked(nullptr, residual).leftCols(kSize);
  information = scores = of_states.transpose() * of_states;
  for (int i = 0; i + 1 < kStates; ++i) {
    const Eigen::MatrixXd all = Stacked(landmarks_[static_cast<size_t>(i)].data(), residual);
    const Eigen::MatrixXd own = all.rightCols(kLandmarkSize);
    // What does not depend on the landmark.
    const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(all.rows(), all.rows()) -
                                 own * (own.transpose() * own).inverse() * own.transpose();
    const Eigen::MatrixXd left = rest * all.leftCols(kSize);
    information += left.transpose() * left;
    const Eigen::VectorXd score = left.transpose() * residual;
    scores += kCommonErrors * score * score.transpose();
  }
  const Eigen::MatrixXd expected = information.inverse() * scores * information.inverse();

  std::unordered_set<const double*> landmarks;
  for (auto& landmark : landmarks_) landmarks.insert(landmark.data());
  const Eigen::MatrixXd covariance =
      MarginalCovariance(problem_, landmarks, {states_[3].data(), states_[1].data()}).value();

  ASSERT_EQ(covariance.rows(), 4);
  EXPECT_LT((covariance.topLeftCorner(2, 2) - expected.block(6, 6, 2, 2)).norm(),
            1e-9 * expected.norm());
  EXPECT_LT((covariance.topRightCorner(2, 2) - expected.block(6, 2, 2, 2)).norm(),
            1e-9 * expected.norm());
  EXPECT_LT((covariance.bottomRightCorner(2, 2) - expected.block(2, 2, 2, 2)).norm(),
            1e-9 * expected.norm());
}

TEST_F(MarginalCovarianceTest, WhatIsHeldHasNone) {
  problem_.SetParameterBlockConstant(states_[0].data());
  std::unordered_set<const double*> landmarks;
  for (auto& landmark : landmarks_) landmarks.insert(landmark.data());
  const Eigen::MatrixXd held = MarginalCovariance(problem_, landmarks, {states_[1].data()}).value();
  problem_.SetParameterBlockVariable(states_[0].data());
  const Eigen::MatrixXd free = MarginalCovariance(problem_, landmarks, {states_[1].data()}).value();
  EXPECT_NE(held, free);
  EXPECT_GT(held.determinant(), 0);
}

TEST(MarginalCovariance, ErrorsOfTheImusScaleCount) {
  // A second of turning and speeding up, from a state that is known: what scale and axes may do
  // comes on top of noise.
  std::vector<ImuSample> samples;
  for (int k = 0; k <= 100; ++k)
    samples.push_back(
        {Timestamp{} + 0.01 * k, {0, 0, 1}, Eigen::Vector3d(2, 0, 0) - kGravityInOdom});
  const ImuPreintegration imu(samples, {}, {});
  std::array<double, kPoseSize> pose_i{}, pose_j{};
  std::array<double, kMotionSize> motion_i{}, motion_j{};
  PoseToParameters({}, pose_i.data());
  PoseToParameters({ExpSo3({0, 0, 1}), {1, 0, 0}}, pose_j.data());
  PoseManifold manifold;
  ceres::Problem::Options options;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(options);
  problem.AddParameterBlock(pose_i.data(), kPoseSize, &manifold);
  problem.AddParameterBlock(pose_j.data(), kPoseSize, &manifold);
  auto* const cost = new ImuCost(&imu);
  problem.AddResidualBlock(cost, nullptr, pose_i.data(), motion_i.data(), pose_j.data(),
                           motion_j.data());
  problem.SetParameterBlockConstant(pose_i.data());
  problem.SetParameterBlockConstant(motion_i.data());

  const Eigen::MatrixXd covariance = MarginalCovariance(problem, {}, {pose_j.data()}).value();

  // All that is free is the second node: H = J^T J of 15 x 15.
  const LinearizableBlock block{cost,
                                nullptr,
                                {pose_i.data(), motion_i.data(), pose_j.data(), motion_j.data()},
                                {0, 6, 15, 21},
                                {6, 9, 6, 9}};
  const std::optional<LinearizedBlock> linear = Linearize(block);
  Eigen::MatrixXd jacobian(15, 15);
  jacobian << linear->jacobians[2], linear->jacobians[3];
  const Eigen::MatrixXd by_noise = (jacobian.transpose() * jacobian).inverse();
  const Eigen::MatrixXd by_scale =
      by_noise * ScoreSensitivity(*cost, imu, block.parameters).bottomRows<15>();
  const Eigen::MatrixXd expected =
      (by_noise + by_scale * by_scale.transpose()).topLeftCorner<6, 6>();
  EXPECT_LT((covariance - expected).norm(), 1e-6 * expected.norm());
  const double of_noise = by_noise.topLeftCorner(6, 6).trace();
  EXPECT_GT(covariance.trace(), 1.05 * of_noise);
}

TEST(MarginalCovariance, SaysNothingOfWhatNothingHolds) {
  double x = 0, y = 0;
  ceres::Problem problem;
  problem.AddResidualBlock(
      new LinearCost(Eigen::MatrixXd::Ones(1, 2), Eigen::VectorXd::Zero(1), {1, 1}), nullptr, &x,
      &y);
  EXPECT_FALSE(MarginalCovariance(problem, {}, {&x}));
}

}  // namespace
}  // namespace parkade
