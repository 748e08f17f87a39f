#include "slam/sessions/session_loop_cost.h"

#include <gtest/gtest.h>

#include <random>

namespace parkade {
namespace {

TEST(SessionLoopCost, JacobiansAreTheSlopesOfItsResidual) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  const auto draw = [&](Eigen::Index rows, Eigen::Index columns, double sigma) -> Eigen::MatrixXd {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return sigma * noise(random); });
  };
  const auto pose = [&] { return Rigid3{ExpSo3(draw(3, 1, 1)), draw(3, 1, 5)}; };
  // Bends are small, as the linear modes have it: the slope of a turn is taken at none.
  const PerturbedPose a{pose(), draw(6, 4, 1e-3)}, b{pose(), draw(6, 2, 1e-3)};
  Eigen::VectorXd frame_a = draw(kFrameSize, 1, 1), bends_a = draw(4, 1, 1),
                  frame_b = draw(kFrameSize, 1, 1), bends_b = draw(2, 1, 1);
  const Rigid3 measured = a.InSite(frame_a.data(), bends_a.data()).Inverse() *
                          b.InSite(frame_b.data(), bends_b.data()) *
                          Rigid3{ExpSo3(draw(3, 1, 0.05)), draw(3, 1, 0.1)};
  const SessionLoopCost cost(a, b, measured, draw(6, 6, 1));

  Eigen::VectorXd* const blocks[] = {&frame_a, &bends_a, &frame_b, &bends_b};
  const double* const parameters[] = {frame_a.data(), bends_a.data(), frame_b.data(),
                                      bends_b.data()};
  for (size_t block = 0; block < 4; ++block) {
    const Eigen::Index size = blocks[block]->size();
    Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor> jacobian(6, size);
    double* jacobians[] = {nullptr, nullptr, nullptr, nullptr};
    jacobians[block] = jacobian.data();
    Vector6d residual, before, after;
    ASSERT_TRUE(cost.Evaluate(parameters, residual.data(), jacobians));
    for (Eigen::Index k = 0; k < size; ++k) {
      constexpr double kStep = 1e-5;
      const double value = (*blocks[block])[k];
      (*blocks[block])[k] = value - kStep;
      cost.Evaluate(parameters, before.data(), nullptr);
      (*blocks[block])[k] = value + kStep;
      cost.Evaluate(parameters, after.data(), nullptr);
      (*blocks[block])[k] = value;
      const Vector6d slope = (after - before) / (2 * kStep);
      EXPECT_LT((jacobian.col(k) - slope).norm(), 2e-3 * std::max(slope.norm(), 1e-3))
          << block << ", " << k;
    }
  }
}

}  // namespace
}  // namespace parkade
