#include "slam/georeference/align_points.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cassert>
#include <cmath>

namespace parkade {

SimilarityAlignment AlignPoints(const Eigen::Matrix3Xd& source, const Eigen::Matrix3Xd& target) {
  assert(source.cols() == target.cols() && source.cols() >= 1);
  const Eigen::Matrix4d rigid = Eigen::umeyama(source, target, /*with_scaling=*/false);
  SimilarityAlignment alignment;
  alignment.target_from_source.rotation =
      Eigen::Quaterniond(Eigen::Matrix3d(rigid.topLeftCorner<3, 3>())).normalized();
  alignment.target_from_source.translation = rigid.topRightCorner<3, 1>();
  const double scale =
      Eigen::umeyama(source, target, /*with_scaling=*/true).topLeftCorner<3, 1>().norm();
  if (std::isfinite(scale)) alignment.scale = scale;  // points that are all one have none
  return alignment;
}

Rigid3 AlignYawAndTranslation(const Eigen::Matrix3Xd& source, const Eigen::Matrix3Xd& target,
                              const Eigen::VectorXd& horizontal_weights,
                              const Eigen::VectorXd& vertical_weights) {
  assert(source.cols() == target.cols() && source.cols() >= 1);
  const double total = horizontal_weights.sum();
  const Eigen::Vector2d source_mean = source.topRows<2>() * horizontal_weights / total;
  const Eigen::Vector2d target_mean = target.topRows<2>() * horizontal_weights / total;
  double along = 0, across = 0;
  for (Eigen::Index i = 0; i < source.cols(); ++i) {
    const Eigen::Vector2d s = source.col(i).head<2>() - source_mean;
    const Eigen::Vector2d t = target.col(i).head<2>() - target_mean;
    along += horizontal_weights[i] * s.dot(t);
    across += horizontal_weights[i] * (s.x() * t.y() - s.y() * t.x());
  }
  Rigid3 target_from_source;
  target_from_source.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(std::atan2(across, along), Eigen::Vector3d::UnitZ()));
  const double rise =
      (target.row(2) - source.row(2)).dot(vertical_weights) / vertical_weights.sum();
  const Eigen::Vector3d turned_mean =
      target_from_source.rotation * Eigen::Vector3d(source_mean.x(), source_mean.y(), 0);
  target_from_source.translation << target_mean - turned_mean.head<2>(), rise;
  return target_from_source;
}

}  // namespace parkade
