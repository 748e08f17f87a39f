#include "slam/georeference/align_points.h"

#include <Eigen/SVD>
#include <cassert>

namespace parkade {

SimilarityAlignment AlignPoints(const Eigen::Matrix3Xd& source, const Eigen::Matrix3Xd& target) {
  assert(source.cols() == target.cols() && source.cols() >= 1);
  const Eigen::Vector3d source_mean = source.rowwise().mean();
  const Eigen::Vector3d target_mean = target.rowwise().mean();
  const Eigen::Matrix3Xd centered_source = source.colwise() - source_mean;
  const Eigen::Matrix3d covariance = (target.colwise() - target_mean) *
                                     centered_source.transpose() /
                                     static_cast<double>(source.cols());
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) signs.z() = -1;
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();

  SimilarityAlignment alignment;
  alignment.target_from_source.rotation = Eigen::Quaterniond(rotation).normalized();
  alignment.target_from_source.translation = target_mean - rotation * source_mean;
  const double variance = centered_source.squaredNorm() / static_cast<double>(source.cols());
  if (variance > 0) alignment.scale = svd.singularValues().dot(signs) / variance;
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
