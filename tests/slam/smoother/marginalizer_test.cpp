#include "slam/smoother/marginalizer.h"

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <deque>
#include <random>

namespace parkade {
namespace {

/// r = A x + B y + ... + c with random matrices.
class RandomLinearCost final : public ceres::CostFunction {
 public:
  RandomLinearCost(int num_residuals, const std::vector<int>& sizes, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    set_num_residuals(num_residuals);
    *mutable_parameter_block_sizes() = sizes;
    for (const int size : sizes)
      matrices.push_back(
          Eigen::MatrixXd::NullaryExpr(num_residuals, size, [&] { return normal(random); }));
    offset = Eigen::VectorXd::NullaryExpr(num_residuals, [&] { return normal(random); });
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd> residual(residuals, num_residuals());
    residual = offset;
    for (size_t i = 0; i < matrices.size(); ++i) {
      residual +=
          matrices[i] * Eigen::Map<const Eigen::VectorXd>(parameters[i], matrices[i].cols());
      if (jacobians && jacobians[i])
        Eigen::Map<Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(
            jacobians[i], num_residuals(), matrices[i].cols()) = matrices[i];
    }
    return true;
  }

  std::vector<Eigen::MatrixXd> matrices;
  Eigen::VectorXd offset;
};

// Two dropped columns, five kept ones, landmarks with three each.
class SmallSystem : public testing::Test {
 protected:
  SmallSystem() {
    for (std::uint32_t k = 0; k < 4; ++k)
      observations_a_.emplace_back(2, std::vector<int>{2, 3}, 10 + k);
    for (std::uint32_t k = 0; k < 3; ++k)
      observations_b_.emplace_back(2, std::vector<int>{5, 3}, 20 + k);
    // Dense reference: columns [dropped 2 | kept 5 | landmark a 3 | landmark b 3].
    const auto add = [&](const RandomLinearCost& cost, const std::vector<int>& columns) {
      const Eigen::Index row = dense_.rows();
      dense_.conservativeResizeLike(Eigen::MatrixXd::Zero(row + cost.num_residuals(), 14));
      for (size_t i = 0; i < columns.size(); ++i)
        dense_.block(row, columns[i], cost.num_residuals(), cost.matrices[i].cols()) =
            cost.matrices[i];
      dense_.block(row, 13, cost.num_residuals(), 1) = cost.offset;
    };
    add(factor_, {0, 2});
    for (const auto& cost : observations_a_) add(cost, {0, 7});
    for (const auto& cost : observations_b_) add(cost, {2, 10});
  }

  LinearizableBlock Block(const RandomLinearCost& cost, std::vector<int> columns) const {
    LinearizableBlock block{&cost, nullptr, {}, std::move(columns), cost.parameter_block_sizes()};
    block.parameters.assign(cost.matrices.size(), zeros_);
    return block;
  }

  const double zeros_[8] = {};
  RandomLinearCost factor_{6, {2, 5}, 1};
  std::deque<RandomLinearCost> observations_a_, observations_b_;
  Eigen::MatrixXd dense_;
};

TEST_F(SmallSystem, LeavesWhatTheWholeSystemSaysAboutTheRest) {
  Marginalizer marginalizer(2, 5);
  ASSERT_TRUE(marginalizer.Add(Block(factor_, {0, 2})));
  std::vector<LinearizableBlock> a, b;
  for (const auto& cost : observations_a_) a.push_back(Block(cost, {0, 0}));
  for (const auto& cost : observations_b_) b.push_back(Block(cost, {2, 0}));
  ASSERT_TRUE(marginalizer.AddLandmark(a));
  ASSERT_TRUE(marginalizer.AddLandmark(b));

  const Marginalizer::Result result = marginalizer.Finish();

  // Slow way: Schur complement of the normal equations.
  std::vector<int> order{2, 3, 4, 5, 6, 0, 1, 7, 8, 9, 10, 11, 12};
  Eigen::MatrixXd jacobian(dense_.rows(), 13);
  for (int c = 0; c < 13; ++c) jacobian.col(c) = dense_.col(order[static_cast<size_t>(c)]);
  const Eigen::MatrixXd information = jacobian.transpose() * jacobian;
  const Eigen::VectorXd gradient = jacobian.transpose() * dense_.col(13);
  const Eigen::MatrixXd gain =
      information.topRightCorner(5, 8) * information.bottomRightCorner(8, 8).inverse();
  const Eigen::MatrixXd expected =
      information.topLeftCorner(5, 5) - gain * information.bottomLeftCorner(8, 5);
  const Eigen::VectorXd expected_gradient = gradient.head(5) - gain * gradient.tail(8);
  EXPECT_LT((result.sqrt_information.transpose() * result.sqrt_information - expected).norm(),
            1e-9 * expected.norm());
  EXPECT_LT((result.sqrt_information.transpose() * result.offset - expected_gradient).norm(),
            1e-9 * expected.norm());
}

TEST_F(SmallSystem, ARobustLossWeakensAnOutlier) {
  const ceres::CauchyLoss loss(0.1);
  const auto information_of = [&](const ceres::LossFunction* robust) {
    Marginalizer marginalizer(2, 5);
    LinearizableBlock block = Block(factor_, {0, 2});
    block.loss = robust;
    EXPECT_TRUE(marginalizer.Add(block));
    return marginalizer.Finish().sqrt_information.norm();
  };

  EXPECT_LT(information_of(&loss), 0.5 * information_of(nullptr));
}

TEST_F(SmallSystem, ALandmarkSeenOnceSaysNothing) {
  Marginalizer marginalizer(2, 5);
  const std::vector<LinearizableBlock> once{Block(observations_a_[0], {0, 0})};

  EXPECT_FALSE(marginalizer.AddLandmark(once));
  EXPECT_EQ(marginalizer.Finish().sqrt_information.norm(), 0);
}

}  // namespace
}  // namespace parkade
