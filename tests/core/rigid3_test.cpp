#include "core/rigid3.h"

#include <gtest/gtest.h>

#include <random>

#include "core/error.h"

namespace parkade {
namespace {

const Rigid3 kMotion{Eigen::Quaterniond(0.9, 0.1, -0.2, 0.3).normalized(), {1, -2, 3}};
const Rigid3 kOther{Eigen::Quaterniond(0.2, -0.8, 0.1, 0.5).normalized(), {-4, 0.5, 7}};

std::vector<Eigen::Vector3d> RotationVectors() {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> vectors = {Eigen::Vector3d::Zero()};
  for (const double length : {1e-12, 1e-6, 0.9e-4, 1.1e-4, 0.01, 1.0, 3.0})
    vectors.push_back(length *
                      Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized());
  return vectors;
}

TEST(Rigid3, NeighborsCancelAsMatricesDo) {
  const Eigen::Vector3d point(0.3, 0.4, 0.5);
  EXPECT_LT(((kMotion * kOther).Matrix() - kMotion.Matrix() * kOther.Matrix()).norm(), 1e-12);
  EXPECT_LT((kMotion * (kOther * point) - (kMotion * kOther) * point).norm(), 1e-12);
  EXPECT_LT(((kMotion * kMotion.Inverse()).Matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-12);
}

TEST(Rigid3, FromMatrixTakesRoundedMatricesAndRefusesOthers) {
  const Eigen::Matrix4d rounded = (kMotion.Matrix() * 1e5).array().round() / 1e5;
  EXPECT_LT((Rigid3::FromMatrix(rounded).Matrix() - kMotion.Matrix()).norm(), 3e-5);

  Eigen::Matrix4d scaled = kMotion.Matrix(), mirrored = kMotion.Matrix(),
                  transposed = kMotion.Matrix().transpose();
  scaled.topLeftCorner<3, 3>() *= 1.01;
  mirrored.col(0) *= -1;
  EXPECT_THROW(Rigid3::FromMatrix(scaled), Error);
  EXPECT_THROW(Rigid3::FromMatrix(mirrored), Error);
  EXPECT_THROW(Rigid3::FromMatrix(transposed), Error);
  EXPECT_THROW(Rigid3::FromMatrix(Eigen::Matrix4d::Constant(NAN)), Error);
}

TEST(Rigid3, LogInvertsExpAtZeroNearZeroAndNearHalfATurn) {
  for (const Eigen::Vector3d& w : RotationVectors()) {
    const Eigen::Quaterniond rotation = ExpSo3(w);
    EXPECT_LT((LogSo3(rotation) - w).norm(), 1e-12 * (1 + w.norm())) << w.transpose();
    // The other sign of a quaternion is the same rotation.
    EXPECT_LT((LogSo3(Eigen::Quaterniond(-rotation.coeffs())) - w).norm(), 1e-12 * (1 + w.norm()));
    const double angle = w.norm();
    if (angle > 1e-3) {
      EXPECT_LT(
          (rotation.toRotationMatrix() - Eigen::AngleAxisd(angle, w / angle).toRotationMatrix())
              .norm(),
          1e-12);
    }
  }
}

TEST(Rigid3, RightJacobianMatchesFiniteDifferences) {
  for (const Eigen::Vector3d& w : RotationVectors()) {
    Eigen::Matrix3d numeric;
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
      numeric.col(i) = (LogSo3(ExpSo3(w).conjugate() * ExpSo3(w + step)) -
                        LogSo3(ExpSo3(w).conjugate() * ExpSo3(w - step))) /
                       (2 * kStep);
    }
    EXPECT_LT((RightJacobianSo3(w) - numeric).norm(), 1e-8) << w.transpose();
    EXPECT_LT(
        (RightJacobianSo3(w) * InverseRightJacobianSo3(w) - Eigen::Matrix3d::Identity()).norm(),
        1e-9);
  }
}

TEST(Rigid3, SkewIsTheCrossProduct) {
  const Eigen::Vector3d a(1, 2, 3), b(-4, 5, 6);
  EXPECT_EQ(Skew(a) * b, a.cross(b));
}

TEST(Rigid3, InterpolationTurnsAndMovesEvenly) {
  const Rigid3 half = Interpolate(kMotion, kOther, 0.5);
  EXPECT_NEAR(kMotion.rotation.angularDistance(half.rotation),
              half.rotation.angularDistance(kOther.rotation), 1e-12);
  EXPECT_LT((half.translation - 0.5 * (kMotion.translation + kOther.translation)).norm(), 1e-12);
  EXPECT_LT((Interpolate(kMotion, kOther, 0).Matrix() - kMotion.Matrix()).norm(), 1e-12);
  EXPECT_LT((Interpolate(kMotion, kOther, 1).Matrix() - kOther.Matrix()).norm(), 1e-12);
}

}  // namespace
}  // namespace parkade
