#include "slam/refinement/covariance_modes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "slam/pose_graph/pose_graph.h"

namespace parkade {
namespace {

/// The covariance of a straight drive whose speed is off by a hundredth and whose heading walks:
/// poses a meter apart.
Eigen::MatrixXd CovarianceOfWalk(int count) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(6 * count, 6 * count);
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j) {
      covariance(6 * i + 3, 6 * j + 3) = 1e-4 * i * j;
      covariance(6 * i + 2, 6 * j + 2) = 1e-7 * std::min(i, j);
      covariance(6 * i + 4, 6 * j + 4) = 1e-7 * std::min(i, j) * std::min(i, j);
    }
  return covariance;
}

std::vector<Timestamp> Seconds(int count) {
  std::vector<Timestamp> times;
  for (int i = 0; i < count; ++i) times.push_back(Timestamp{} + static_cast<double>(i));
  return times;
}

TEST(CovarianceModes, FewHoldNearlyAllOfTheCovariance) {
  const Eigen::MatrixXd covariance = CovarianceOfWalk(30);
  const CovarianceModes modes = FindCovarianceModes(Seconds(30), covariance);
  EXPECT_LT(modes.size(), 40);
  EXPECT_GE(modes.size(), 2);
  const Eigen::VectorXd left_out = (covariance - modes.modes * modes.modes.transpose()).diagonal();
  EXPECT_GE(left_out.minCoeff(), -1e-12);
  EXPECT_LT(left_out.sum(), 30 * 1e-6) << "[m^2]: a millimeter per place";
}

TEST(CovarianceModes, LieBetweenTheirTimesAndStayBeyond) {
  CovarianceModes modes{Seconds(2), Eigen::MatrixXd::Zero(12, 1)};
  modes.modes(3, 0) = 1;
  modes.modes(9, 0) = 3;
  EXPECT_DOUBLE_EQ(modes.At(Timestamp{} + 0.25)(3, 0), 1.5);
  EXPECT_DOUBLE_EQ(modes.At(Timestamp{} + 1.0)(3, 0), 3);
  EXPECT_DOUBLE_EQ(modes.At(Timestamp{} + 7.0)(3, 0), 3);
  EXPECT_DOUBLE_EQ(modes.At(Timestamp{} + -7.0)(3, 0), 1);
}

TEST(CovarianceModes, GiveATrajectoryItsCovariances) {
  TrajectoryState state;
  state.world_from_body.rotation = ExpSo3({0, 0, M_PI / 2});
  CovarianceModes modes{Seconds(1), Eigen::MatrixXd::Zero(6, 2)};
  modes.modes(0, 0) = 0.01;  // about x of odom, which is -y of the body
  modes.modes(3, 0) = 0.2;
  modes.modes(4, 1) = 0.1;
  const Matrix6d covariance = WithCovariances(Trajectory({state}), modes).states()[0].covariance;
  Matrix6d expected = Matrix6d::Zero();
  expected(1, 1) = 1e-4;
  expected(3, 3) = 0.04;
  expected(4, 4) = 0.01;
  expected(1, 3) = expected(3, 1) = -0.002;
  EXPECT_LT((covariance - expected).norm(), 1e-12) << covariance;
}

TEST(CovarianceModes, BendTurnsAboutThePoseItself) {
  const Rigid3 pose{ExpSo3({0, 0, 1}), {10, 20, 30}};
  Eigen::Matrix<double, 6, 1> error;
  error << 0, 0, 0.1, 1, 0, 0;
  const Rigid3 bent = Bent(pose, error);
  EXPECT_LT((bent.translation - Eigen::Vector3d(11, 20, 30)).norm(), 1e-12);
  EXPECT_NEAR(bent.rotation.angularDistance(ExpSo3({0, 0, 1.1})), 0, 1e-7);
}

}  // namespace
}  // namespace parkade
