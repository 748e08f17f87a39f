#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "slam/smoother_window.h"

namespace parkade {
namespace {

constexpr Eigen::Index kState = kPoseTangentSize + kMotionSize;
constexpr int kNumKnots = 3;

using Kind = StateName::Kind;

PriorBlock PoseOf(std::int64_t knot) {
  PriorBlock block{{Kind::kPose, knot}, {}};
  PoseToParameters(Rigid3{}, block.at.data());
  return block;
}

PriorBlock MotionOf(std::int64_t knot) { return {{Kind::kMotion, knot}, {}}; }

/// r = J x + noise for three knots, weighted as if the noise were white and of unit variance, which it is not.
class WrongWeights : public testing::Test {
 protected:
  WrongWeights() {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    const Eigen::Index size = kNumKnots * kState, rows = 3 * size;
    const auto draw = [&] { return normal(random); };
    const Eigen::MatrixXd jacobian = Eigen::MatrixXd::NullaryExpr(rows, size, draw);
    const Eigen::MatrixXd mixing = Eigen::MatrixXd::NullaryExpr(rows, rows, draw);
    information_ = jacobian.transpose() * jacobian;
    score_covariance_ = jacobian.transpose() * mixing * mixing.transpose() * jacobian;
    sensitivity_ = jacobian.transpose() * Eigen::MatrixXd::NullaryExpr(rows, 4, draw);
    const Eigen::MatrixXd inverse = information_.inverse();
    expected_ = inverse * (score_covariance_ + sensitivity_ * sensitivity_.transpose()) * inverse;
  }

  Eigen::MatrixXd information_, score_covariance_;
  Eigen::MatrixXd sensitivity_;  ///< of the score, by four constants of unit variance that nobody estimates
  Eigen::MatrixXd expected_;     ///< covariance of the least-squares estimate
};

TEST_F(WrongWeights, EliminationLeavesTheCovarianceOfTheRest) {
  const Eigen::MatrixXd root = information_.topLeftCorner(kState, kState).llt().matrixU();
  const Eigen::MatrixXd to_kept =
      root.transpose().triangularView<Eigen::Lower>().solve(information_.topRightCorner(kState, 2 * kState));

  const ScoreElimination scores = EliminateScores(score_covariance_, sensitivity_, root, to_kept);

  const Eigen::MatrixXd kept =
      (information_.bottomRightCorner(2 * kState, 2 * kState) - to_kept.transpose() * to_kept).inverse();
  const Eigen::MatrixXd by_constants = kept * scores.kept_sensitivity;
  const Eigen::MatrixXd covariance = kept * scores.kept * kept + by_constants * by_constants.transpose();
  EXPECT_LT((covariance - expected_.bottomRightCorner(2 * kState, 2 * kState)).norm(), 1e-9 * expected_.norm());
}

TEST_F(WrongWeights, RightOnesLeaveTheInformation) {
  const Eigen::MatrixXd root = information_.topLeftCorner(kState, kState).llt().matrixU();
  const Eigen::MatrixXd to_kept =
      root.transpose().triangularView<Eigen::Lower>().solve(information_.topRightCorner(kState, 2 * kState));

  const ScoreElimination scores = EliminateScores(information_, sensitivity_, root, to_kept);

  EXPECT_LT((scores.dropped - Eigen::MatrixXd::Identity(kState, kState)).norm(), 1e-9);
  EXPECT_LT(scores.cross.norm(), 1e-9 * information_.norm());
}

TEST_F(WrongWeights, SmoothingBackwardsGivesTheCovariancesOfTheWholeSystem) {
  std::vector<FinishedKnot> knots;
  Eigen::MatrixXd information = information_, score_covariance = score_covariance_, sensitivity = sensitivity_;
  for (int number = 0; number + 1 < kNumKnots; ++number) {
    const Eigen::Index kept = information.cols() - kState;
    const Eigen::MatrixXd root = information.topLeftCorner(kState, kState).llt().matrixU();
    const Eigen::MatrixXd to_kept =
        root.transpose().triangularView<Eigen::Lower>().solve(information.topRightCorner(kState, kept));
    const ScoreElimination scores = EliminateScores(score_covariance, sensitivity, root, to_kept);
    StateConditional conditional{{PoseOf(number), MotionOf(number)},
                                 root.cast<float>(),
                                 to_kept.cast<float>(),
                                 Eigen::VectorXf::Zero(kState),
                                 scores.dropped.cast<float>(),
                                 scores.cross.cast<float>(),
                                 scores.dropped_sensitivity.cast<float>(),
                                 {}};
    for (int rest = number + 1; rest < kNumKnots; ++rest) {
      conditional.rest.push_back(PoseOf(rest));
      conditional.rest.push_back(MotionOf(rest));
    }
    FinishedKnot& knot = knots.emplace_back();
    knot.number = number;
    knot.conditional = std::move(conditional);
    information = (information.bottomRightCorner(kept, kept) - to_kept.transpose() * to_kept).eval();
    score_covariance = scores.kept;
    sensitivity = scores.kept_sensitivity;
  }
  knots.emplace_back().number = kNumKnots - 1;
  const Eigen::MatrixXd assumed = information.inverse();
  const Eigen::MatrixXd last_sensitivity = -assumed * sensitivity;
  const JointEstimate last{{PoseOf(kNumKnots - 1), MotionOf(kNumKnots - 1)},
                           assumed * score_covariance * assumed + last_sensitivity * last_sensitivity.transpose(),
                           assumed,
                           last_sensitivity};

  SmoothBackwards(knots, last);

  for (int number = 0; number < kNumKnots; ++number) {
    const Eigen::MatrixXd expected = expected_.block<6, 6>(number * kState, number * kState);
    EXPECT_LT((knots[static_cast<size_t>(number)].covariance - expected).norm(), 1e-4 * expected.norm()) << number;
  }
}

}  // namespace
}  // namespace parkade
