#include "core/math/decompositions.h"

#include <gtest/gtest.h>

#include <cmath>

namespace parkade {
namespace {

Eigen::MatrixXd SymmetricMatrix(int size) {
  const Eigen::MatrixXd root =
      Eigen::MatrixXd::NullaryExpr(size, size, [](Eigen::Index i, Eigen::Index j) {
        return std::sin(static_cast<double>(3 * i + 5 * j + 1));
      });
  return root.transpose() * root;
}

TEST(DecompositionsTest, ASymmetricSystemIsSolved) {
  const Eigen::Matrix3d matrix = SymmetricMatrix(3) + Eigen::Matrix3d::Identity();
  const Eigen::Vector3d x(1, -2, 3);
  EXPECT_TRUE(SolveSymmetric(matrix, matrix * x).isApprox(x, 1e-9));
}

TEST(DecompositionsTest, TheTriangularFactorHasTheSameSquare) {
  const Eigen::MatrixXd rows = SymmetricMatrix(5).leftCols(3);
  const Eigen::MatrixXd factor = TriangularFactor(rows);
  ASSERT_EQ(factor.rows(), 5);
  EXPECT_TRUE((factor.transpose() * factor).isApprox(rows.transpose() * rows, 1e-9));
  EXPECT_EQ(factor(1, 0), 0);
  EXPECT_EQ(factor(4, 2), 0);
}

TEST(DecompositionsTest, TheRotationBetweenDirectionsIsTheSmallest) {
  const Eigen::Vector3d from(1, 2, 3), to(-2, 0.5, 1);
  const Eigen::Quaterniond rotation = RotationBetween(from, to);
  EXPECT_LT((rotation * from.normalized() - to.normalized()).norm(), 1e-12);
  const double between = std::acos(from.normalized().dot(to.normalized()));
  EXPECT_NEAR(rotation.angularDistance(Eigen::Quaterniond::Identity()), between, 1e-9);
}

TEST(DecompositionsTest, OppositeDirectionsHaveARotationBetweenThem) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  EXPECT_LT((RotationBetween(up, -up) * up + up).norm(), 1e-9);
}

TEST(DecompositionsTest, TheNearestRotationOfAScaledRotationIsThatRotation) {
  const Eigen::Quaterniond rotation(
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -1, 0.5).normalized()));
  const Eigen::Matrix3d scaled = 2.5 * rotation.toRotationMatrix();
  EXPECT_LT(NearestRotation(scaled).angularDistance(rotation), 1e-9);
}

TEST(DecompositionsTest, TheNearestRotationOfAReflectionIsNoReflection) {
  const Eigen::Matrix3d mirror = Eigen::Vector3d(1, 1, -0.1).asDiagonal();
  EXPECT_NEAR(NearestRotation(mirror).toRotationMatrix().determinant(), 1, 1e-12);
}

TEST(DecompositionsTest, EigenvectorsAndValuesMakeUpTheMatrix) {
  for (const int size : {1, 2, 3, 6, 8}) {
    const Eigen::MatrixXd matrix = SymmetricMatrix(size);
    const SymmetricEigen eigen = DecomposeSymmetric(matrix);
    EXPECT_TRUE((eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose())
                    .isApprox(matrix, 1e-9))
        << size;
    EXPECT_LT((SymmetricEigenvalues(matrix) - eigen.values).norm(), 1e-9 * matrix.norm()) << size;
    for (int i = 1; i < size; ++i) EXPECT_LE(eigen.values[i - 1], eigen.values[i]) << size;
  }
}

TEST(DecompositionsTest, TheSquareRootSquaredIsTheMatrixAlsoWhereItIsSingular) {
  const Eigen::MatrixXd tall = SymmetricMatrix(6).topRows(3);
  const Eigen::MatrixXd singular = tall.transpose() * tall;
  const Eigen::MatrixXd root = SquareRootOf(singular);
  EXPECT_LT((root.transpose() * root - singular).norm(), 1e-9 * singular.norm());
}

}  // namespace
}  // namespace parkade
