#include "slam/places/adjust_two_views.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/math/decompositions.h"

namespace parkade {
namespace {

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

constexpr int kSteps = 20;
constexpr size_t kMinPairs = 6;
constexpr double kLeastInformation = 1;  // [1/rad^2] at least

Eigen::Matrix<double, 3, 2> TangentOf(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d first = direction.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> tangent;
  tangent << first, direction.cross(first);
  return tangent;
}

/// One pair's error in units of its sigma, and its derivative by [turn on the right | change of
/// direction].
struct EpipolarError {
  double whitened = 0;
  Vector5d jacobian;
  Eigen::Matrix2d by_chance;  ///< the part of jacobian jacobian^T by the direction that noise of
                              ///< the rays alone would show
};

EpipolarError ErrorOf(const RayPair& pair, const Rigid3& a_from_b,
                      const Eigen::Matrix<double, 3, 2>& tangent) {
  const Eigen::Vector3d& direction = a_from_b.translation;
  const Eigen::Vector3d turned = a_from_b.rotation * pair.in_b;
  const Eigen::Vector3d by_a = direction.cross(turned), by_turned = pair.in_a.cross(direction);
  // Along its ray a bearing has no error.
  const double across_a = (by_a - by_a.dot(pair.in_a) * pair.in_a).norm();
  const double across_b = (by_turned - by_turned.dot(turned) * turned).norm();
  const double sigma = std::max(std::hypot(pair.sigma_a * across_a, pair.sigma_b * across_b), 1e-9);
  EpipolarError error;
  error.whitened = pair.in_a.dot(by_a) / sigma;
  error.jacobian << pair.in_b.cross(a_from_b.rotation.conjugate() * by_turned),
      tangent.transpose() * turned.cross(pair.in_a);
  error.jacobian /= sigma;
  const Eigen::Matrix<double, 2, 3> across =
      tangent.transpose() * (Eigen::Matrix3d::Identity() - turned * turned.transpose());
  error.by_chance = (pair.sigma_a * pair.sigma_a + pair.sigma_b * pair.sigma_b) / (sigma * sigma) *
                    across * across.transpose();
  return error;
}

/// The information, without what noise alone would show about the direction: without a baseline
/// nothing else is left.
Matrix5d WithoutChance(const Matrix5d& hessian, const Matrix5d& by_chance) {
  const SymmetricEigen eigen = DecomposeSymmetric(hessian - by_chance);
  return eigen.vectors * eigen.values.cwiseMax(kLeastInformation).asDiagonal() *
         eigen.vectors.transpose();
}

}  // namespace

AdjustedTwoViews AdjustTwoViews(const std::vector<RayPair>& pairs, Rigid3& a_from_b) {
  AdjustedTwoViews adjusted;
  if (pairs.size() < kMinPairs) return adjusted;
  Matrix5d hessian, by_chance;
  double sum = 0;
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::Matrix<double, 3, 2> tangent = TangentOf(a_from_b.translation);
    hessian = kLeastInformation * Matrix5d::Identity();
    by_chance.setZero();
    Vector5d gradient = Vector5d::Zero();
    sum = 0;
    for (const RayPair& pair : pairs) {
      const EpipolarError error = ErrorOf(pair, a_from_b, tangent);
      const double squared = error.whitened * error.whitened, weight = 1 / (1 + squared / 4);
      hessian += weight * error.jacobian * error.jacobian.transpose();
      by_chance.bottomRightCorner<2, 2>() += weight * error.by_chance;
      gradient += weight * error.whitened * error.jacobian;
      sum += squared;
    }
    const Vector5d delta = -hessian.ldlt().solve(gradient);
    a_from_b.rotation = (a_from_b.rotation * ExpSo3(delta.head<3>())).normalized();
    a_from_b.translation = (a_from_b.translation + tangent * delta.tail<2>()).normalized();
    if (delta.norm() < 1e-7) break;
  }
  const double scatter = std::max(1.0, sum / static_cast<double>(pairs.size() - 5));
  const Matrix5d covariance =
      scatter * WithoutChance(hessian, by_chance).ldlt().solve(Matrix5d::Identity());
  adjusted.rotation_covariance = covariance.topLeftCorner<3, 3>();
  const Eigen::Matrix2d of_direction = covariance.bottomRightCorner<2, 2>();
  adjusted.direction_sigma =
      std::min(1.0, std::sqrt(SymmetricEigenvalues(of_direction).maxCoeff()));
  return adjusted;
}

}  // namespace parkade
