#include "slam/schur/schur_kernels.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <vector>

namespace parkade {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::MatrixXd Random(Eigen::Index rows, Eigen::Index columns) {
  std::srand(5);
  return Eigen::MatrixXd::Random(rows, columns);
}

Eigen::MatrixXd Lower(const Eigen::MatrixXd& matrix) {
  return matrix.triangularView<Eigen::Lower>();
}

TEST(SchurKernels, ProductsOfTwoRowsAreAdded) {
  constexpr int kWidth = 6;
  Matrix rows = Matrix::Zero(2, RoundUp(kWidth));
  rows.leftCols(kWidth) = Random(2, kWidth);
  Matrix sum = Matrix::Ones(kWidth, RoundUp(kWidth));

  AddProducts(rows.row(0).data(), rows.row(1).data(), kWidth, RoundUp(kWidth), sum.data());

  const Matrix a = rows.leftCols(kWidth);
  const Eigen::MatrixXd expected = Eigen::MatrixXd::Ones(kWidth, kWidth) + a.transpose() * a;
  EXPECT_LT((Lower(sum.leftCols(kWidth)) - Lower(expected)).norm(), 1e-14);
}

TEST(SchurKernels, ProductsOfPackedColumnsAreSubtractedWhereTheyLie) {
  const std::vector<SchurRun> runs = {{1, 0, 5}, {8, 5, 2}};
  const Matrix packed = Random(3, 7);
  Matrix whole = Matrix::Zero(3, 11);
  whole.middleCols(1, 5) = packed.leftCols(5);
  whole.middleCols(8, 2) = packed.rightCols(2);
  Matrix matrix = Matrix::Zero(11, 11);

  SubtractProducts(packed.data(), 7, runs, matrix.data(), matrix.cols());

  const Eigen::MatrixXd expected = -whole.transpose() * whole;
  EXPECT_LT((matrix - Matrix(Lower(expected))).norm(), 1e-14);
}

TEST(SchurKernels, PanelsAreSubtractedFromSomeRowsAndColumns) {
  const Matrix panel = Random(kLanes, 12);
  Matrix matrix = Matrix::Zero(10, 12);
  Matrix panel_copy = panel;
  const std::array<int, 2> rows = {5, 9};
  const std::array<ColumnRange, 1> columns = {{{4, 12}}};

  SubtractPanel({panel_copy.data(), 12}, rows, columns, {matrix.data(), 12});

  const Eigen::MatrixXd expected = -panel.transpose() * panel;
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column <= row; ++column) {
      const bool is_reached = (row == 5 || row == 9) && column >= 4;
      EXPECT_NEAR(matrix(row, column), is_reached ? expected(row, column) : 0, 1e-14)
          << row << ", " << column;
    }
}

}  // namespace
}  // namespace parkade
