#include "slam/georeference/align_points.h"

#include <gtest/gtest.h>

#include <random>

namespace parkade {
namespace {

Eigen::Matrix3Xd RandomPoints(int count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-10, 10);
  return Eigen::Matrix3Xd::NullaryExpr(3, count, [&] { return uniform(random); });
}

TEST(AlignPoints, ExactMotionAndScaleComeBack) {
  const Eigen::Matrix3Xd source = RandomPoints(20);
  const Rigid3 moved{ExpSo3({0.3, -2.0, 1.1}), {4, -5, 6}};
  Eigen::Matrix3Xd target = source;
  for (Eigen::Index i = 0; i < source.cols(); ++i)
    target.col(i) = moved * Eigen::Vector3d(1.25 * source.col(i));

  const SimilarityAlignment alignment = AlignPoints(source, target);

  EXPECT_NEAR(alignment.scale, 1.25, 1e-12);
  EXPECT_LT(alignment.target_from_source.rotation.angularDistance(moved.rotation), 1e-7);
}

TEST(AlignPoints, MirroredPointsAreNeverAnsweredByAReflection) {
  const Eigen::Matrix3Xd source = RandomPoints(20);
  Eigen::Matrix3Xd target = source;
  target.row(0) *= -1;

  const Eigen::Matrix3d rotation =
      AlignPoints(source, target).target_from_source.rotation.toRotationMatrix();

  EXPECT_NEAR(rotation.determinant(), 1, 1e-12);
}

TEST(AlignYawAndTranslation, TiltIsLeftAloneAndZeroWeightIgnored) {
  const Eigen::Matrix3Xd source = RandomPoints(30);
  const Rigid3 moved{ExpSo3({0, 0, 2.5}), {100, -50, 3}};
  Eigen::Matrix3Xd target = source;
  for (Eigen::Index i = 0; i < source.cols(); ++i)
    target.col(i) = moved * Eigen::Vector3d(source.col(i));
  target.col(7).setConstant(1e6);
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(30, 2.0);
  weights[7] = 0;

  const Rigid3 found = AlignYawAndTranslation(source, target, weights, weights);

  EXPECT_LT((found.translation - moved.translation).norm(), 1e-9);
  EXPECT_LT(found.rotation.angularDistance(moved.rotation), 1e-7);
}

}  // namespace
}  // namespace parkade
