#include "core/math/sparse_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include "core/error.h"

namespace parkade {
namespace {

/// The matrix of a grid whose neighbors are tied with random weights; large enough for supernodes.
/// Lower triangle.
Eigen::SparseMatrix<double> GridMatrix(int side) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> weight(0.5, 2);
  std::vector<Eigen::Triplet<double>> triplets;
  const auto tie = [&](int a, int b) {
    const double w = weight(random);
    triplets.emplace_back(a, a, w);
    triplets.emplace_back(b, b, w);
    triplets.emplace_back(std::max(a, b), std::min(a, b), -w);
  };
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const int node = y * side + x;
      triplets.emplace_back(node, node, 0.01);
      if (x + 1 < side) tie(node, node + 1);
      if (y + 1 < side) tie(node, node + side);
      if (x + 1 < side && y + 1 < side) tie(node, node + side + 1);
    }
  Eigen::SparseMatrix<double> matrix(side * side, side * side);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

TEST(SolveCholesky, GivesWhatADenseOneGives) {
  const Eigen::SparseMatrix<double> matrix = GridMatrix(25);
  const Eigen::VectorXd b = Eigen::VectorXd::Random(matrix.rows());

  const Eigen::VectorXd x = SolveCholesky(matrix, b);

  const Eigen::MatrixXd dense = Eigen::MatrixXd(matrix).selfadjointView<Eigen::Lower>();
  EXPECT_LT((x - dense.llt().solve(b)).norm(), 1e-9 * x.norm());
}

TEST(CholeskySolver, SolvesMatricesOfOnePatternAsIfEachWereAlone) {
  Eigen::SparseMatrix<double> matrix = GridMatrix(25);
  const Eigen::MatrixXd b = Eigen::MatrixXd::Random(matrix.rows(), 2);
  CholeskySolver solver;
  for (int round = 0; round < 3; ++round) {
    EXPECT_EQ(solver.Solve(matrix, b), SolveCholesky(matrix, b)) << round;
    for (int i = 0; i < matrix.rows(); ++i) matrix.coeffRef(i, i) += 0.1 * (i % 7);
  }
  matrix.coeffRef(4, 4) = -1;
  EXPECT_THROW(solver.Solve(matrix, b), Error);
}

double EnergyNorm(const Eigen::SparseMatrix<double>& matrix, const Eigen::VectorXd& x) {
  return std::sqrt(x.dot(matrix.selfadjointView<Eigen::Lower>() * x));
}

class SimilarMatrices : public testing::TestWithParam<double> {};

TEST_P(SimilarMatrices, AreSolvedToAboutAHundredth) {
  Eigen::SparseMatrix<double> matrix = GridMatrix(25);
  for (int i = 0; i < matrix.rows(); ++i) matrix.coeffRef(i, i) += 3;
  const Eigen::VectorXd b = Eigen::VectorXd::Random(matrix.rows());
  CholeskySolver solver;
  bool was_close = false;
  for (int round = 0; round < 6; ++round) {
    const Eigen::VectorXd x = solver.SolveSimilar(matrix, b), exact = SolveCholesky(matrix, b);
    EXPECT_LE(EnergyNorm(matrix, x - exact), 0.02 * EnergyNorm(matrix, exact)) << round;
    if (round == 0) {
      EXPECT_EQ(x, exact);
    }
    was_close |= x != exact;
    for (int i = 0; i < matrix.rows(); ++i) matrix.coeffRef(i, i) += GetParam() * (i % 7);
  }
  EXPECT_TRUE(was_close) << "each was factorized anew";
}

INSTANTIATE_TEST_SUITE_P(ThatGetStiffer, SimilarMatrices, testing::Values(0.1));
INSTANTIATE_TEST_SUITE_P(ThatGetSofter, SimilarMatrices, testing::Values(-0.09));

TEST(CholeskySolver, FactorizesAnewWhatIsNotSimilar) {
  Eigen::SparseMatrix<double> matrix = GridMatrix(25);
  const Eigen::VectorXd b = Eigen::VectorXd::Random(matrix.rows());
  CholeskySolver solver;
  solver.SolveSimilar(matrix, b);
  for (int i = 0; i < matrix.rows(); ++i) matrix.coeffRef(i, i) += std::pow(10.0, i % 7);
  EXPECT_EQ(solver.SolveSimilar(matrix, b), SolveCholesky(matrix, b));

  const double sound = matrix.coeff(4, 4);
  matrix.coeffRef(4, 4) = -1e9;
  EXPECT_THROW(solver.SolveSimilar(matrix, b), Error);
  matrix.coeffRef(4, 4) = sound;
  EXPECT_EQ(solver.SolveSimilar(matrix, b), SolveCholesky(matrix, b));
}

TEST(CholeskySolver, GivesColumnsOfTheInverse) {
  const Eigen::SparseMatrix<double> matrix = GridMatrix(12);
  std::vector<int> columns(70);  // more than are solved for at a time
  for (size_t i = 0; i < columns.size(); ++i) columns[i] = static_cast<int>((37 * i) % 144);
  const Eigen::MatrixXd some = CholeskySolver().InverseColumns(matrix, columns);

  const Eigen::MatrixXd dense = Eigen::MatrixXd(matrix).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd inverse = dense.inverse();
  ASSERT_EQ(some.cols(), 70);
  for (size_t i = 0; i < columns.size(); ++i)
    EXPECT_LT((some.col(static_cast<Eigen::Index>(i)) - inverse.col(columns[i])).norm(), 1e-9) << i;
}

TEST(SolveCholesky, RefusesWhatIsNotPositiveDefinite) {
  Eigen::SparseMatrix<double> matrix = GridMatrix(3);
  matrix.coeffRef(4, 4) = -1;
  EXPECT_THROW(SolveCholesky(matrix, Eigen::VectorXd::Ones(9)), Error);
}

}  // namespace
}  // namespace parkade
