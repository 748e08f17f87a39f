#include "slam/schur/envelope_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace parkade {
namespace {

/// Chained blocks, as motions are, below which each row reaches far back.
std::vector<int> FirstColumns(int size) {
  std::vector<int> first;
  first.reserve(static_cast<size_t>(size));
  for (int row = 0; row < size; ++row)
    first.push_back(row < size / 2 ? std::max(0, row / 9 * 9 - 9) : std::max(0, row - size / 2));
  return first;
}

/// Positive definite, with zeros before the first columns.
Eigen::MatrixXd RandomMatrix(const std::vector<int>& first_columns) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto size = static_cast<Eigen::Index>(first_columns.size());
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index row = 0; row < size; ++row) {
    for (Eigen::Index column = first_columns[static_cast<size_t>(row)]; column < row; ++column)
      root(row, column) = uniform(random);
    root(row, row) = 4;
  }
  return root * root.transpose();
}

EnvelopeMatrix Filled(const std::vector<int>& first_columns, const Eigen::MatrixXd& with) {
  EnvelopeMatrix matrix(first_columns);
  for (int row = 0; row < matrix.size(); ++row)
    for (int column = first_columns[static_cast<size_t>(row)]; column <= row; ++column)
      matrix.Row(row)[column] = with(row, column);
  return matrix;
}

TEST(EnvelopeMatrix, SolvesAsADenseCholeskyDoes) {
  for (const int size : {1, 4, 7, 30, 101}) {
    const std::vector<int> first_columns = FirstColumns(size);
    const Eigen::MatrixXd a = RandomMatrix(first_columns);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(size, -1, 2);

    const std::optional<Eigen::VectorXd> x = Filled(first_columns, a).Solve(b);

    ASSERT_TRUE(x) << size;
    const Eigen::VectorXd expected = a.llt().solve(b);
    EXPECT_LT((*x - expected).norm(), 1e-10 * expected.norm()) << size;
  }
}

TEST(EnvelopeMatrix, SolvesAgainAfterItWasSetToZero) {
  const std::vector<int> first_columns = FirstColumns(20);
  const Eigen::MatrixXd a = RandomMatrix(first_columns);
  EnvelopeMatrix matrix = Filled(first_columns, a);
  matrix.Solve(Eigen::VectorXd::Ones(20));

  matrix.SetZero();
  for (int row = 0; row < 20; ++row) matrix.Row(row)[row] = 2;
  const std::optional<Eigen::VectorXd> x = matrix.Solve(Eigen::VectorXd::Ones(20));

  ASSERT_TRUE(x);
  EXPECT_LT((*x - Eigen::VectorXd::Constant(20, 0.5)).norm(), 1e-15);
}

TEST(EnvelopeMatrix, WhatIsNotPositiveDefiniteHasNoSolution) {
  const std::vector<int> first_columns = FirstColumns(20);
  Eigen::MatrixXd a = RandomMatrix(first_columns);
  a(13, 13) = -1;

  EXPECT_FALSE(Filled(first_columns, a).Solve(Eigen::VectorXd::Ones(20)));
}

}  // namespace
}  // namespace parkade
