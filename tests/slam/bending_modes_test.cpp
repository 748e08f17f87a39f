#include "slam/bending_modes.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

/// Of a drive straight on whose speed is off by a hundredth and whose heading walks: 30 places, one in a metre.
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

TEST(BendingModes, FewHoldNearlyAllOfTheCovariance) {
  const Eigen::MatrixXd covariance = CovarianceOfWalk(30);
  const BendingModes modes = FindBendingModes(Seconds(30), covariance);
  EXPECT_LT(modes.size(), 40);
  EXPECT_GE(modes.size(), 2);
  const Eigen::VectorXd left_out = (covariance - modes.modes * modes.modes.transpose()).diagonal();
  EXPECT_GE(left_out.minCoeff(), -1e-12);
  EXPECT_LT(left_out.sum(), 30 * 1e-6) << "[m^2]: a millimetre per place";
}

TEST(BendingModes, LieBetweenTheirTimesAndStayBeyond) {
  BendingModes modes{Seconds(2), Eigen::MatrixXd::Zero(12, 1)};
  modes.modes(3, 0) = 1;
  modes.modes(9, 0) = 3;
  EXPECT_DOUBLE_EQ(modes.At(Timestamp{} + 0.25)(3, 0), 1.5);
  EXPECT_DOUBLE_EQ(modes.At(Timestamp{} + 1.0)(3, 0), 3);
  EXPECT_DOUBLE_EQ(modes.At(Timestamp{} + 7.0)(3, 0), 3);
  EXPECT_DOUBLE_EQ(modes.At(Timestamp{} + -7.0)(3, 0), 1);
}

TEST(BendingModes, BendTurnsAboutThePoseItself) {
  const Rigid3 pose{ExpSo3({0, 0, 1}), {10, 20, 30}};
  Eigen::Matrix<double, 6, 1> error;
  error << 0, 0, 0.1, 1, 0, 0;
  const Rigid3 bent = Bent(pose, error);
  EXPECT_LT((bent.translation - Eigen::Vector3d(11, 20, 30)).norm(), 1e-12);
  EXPECT_NEAR(bent.rotation.angularDistance(ExpSo3({0, 0, 1.1})), 0, 1e-7);
}

}  // namespace
}  // namespace parkade
