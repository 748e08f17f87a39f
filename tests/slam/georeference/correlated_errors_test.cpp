#include "slam/georeference/correlated_errors.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace parkade {
namespace {

Eigen::VectorXd UnevenTimes(int count) {
  Eigen::VectorXd times(count);
  double time = 0;
  for (int i = 0; i < count; ++i) times[i] = time += 0.2 + (i % 7 == 0 ? 3.0 : 0.0);
  return times;
}

/// The covariance of the errors of a series; weights as WhitenRows takes them.
Eigen::MatrixXd CovarianceOf(const Eigen::VectorXd& times, const Eigen::VectorXd& weights,
                             const ErrorModel& model) {
  const auto count = times.size();
  Eigen::MatrixXd covariance(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index k = 0; k < count; ++k) {
      covariance(i, k) = (1 - model.white_variance) *
                         std::exp(-std::abs(times[i] - times[k]) / model.correlation_time);
      if (i == k) covariance(i, k) += model.white_variance / weights[i];
    }
  return covariance;
}

TEST(CorrelatedErrors, WhitenedRowsHaveTheInformationOfTheFullCovariance) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const int count = 60;
  Eigen::MatrixXd rows(count, 3);
  Eigen::VectorXd weights(count);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) rows(i, k) = normal(random);
    weights[i] = i % 5 == 0 ? 0.1 : 1;
  }
  const Eigen::VectorXd times = UnevenTimes(count);
  const ErrorModel model{20, 0.2};
  const Eigen::MatrixXd white = WhitenRows(rows, times, weights, model);
  const Eigen::MatrixXd expected =
      rows.transpose() * CovarianceOf(times, weights, model).ldlt().solve(rows);
  EXPECT_LT((white.transpose() * white - expected).norm(), 1e-9 * expected.norm());
}

TEST(CorrelatedErrors, WithoutASlowPartNothingChanges) {
  const Eigen::MatrixXd rows = Eigen::MatrixXd::Random(20, 2);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(20);
  EXPECT_LT((WhitenRows(rows, UnevenTimes(20), ones, {0, 1}) - rows).norm(), 1e-12);
}

TEST(CorrelatedErrors, TheWhiteShareIsFound) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const double share : {0.04, 0.3, 1.0}) {
    const double memory = std::exp(-0.2 / 60);
    Eigen::VectorXd values(3000), times(3000);
    double slow = normal(random);
    for (int i = 0; i < 3000; ++i) {
      slow = memory * slow + std::sqrt(1 - memory * memory) * normal(random);
      values[i] = std::sqrt(1 - share) * slow + std::sqrt(share) * normal(random);
      times[i] = 0.2 * i;
    }
    for (int i = 100; i < 110; ++i) values[i] += 40;  // a reflection
    EXPECT_NEAR(EstimateWhiteVariance(values, times, 60), share, 0.15 * share);
  }
  EXPECT_EQ(EstimateWhiteVariance(Eigen::VectorXd::Zero(5), UnevenTimes(5), 60), 1);
}

}  // namespace
}  // namespace parkade
