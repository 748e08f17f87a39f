#include "slam/sight.h"

#include <Eigen/SVD>

namespace parkade {
namespace {

/// Two unit vectors across `bearing`, as rows.
Eigen::Matrix<double, 2, 3> BasisAcross(const Eigen::Vector3d& bearing) {
  const Eigen::Vector3d first = bearing.unitOrthogonal();
  Eigen::Matrix<double, 2, 3> basis;
  basis << first.transpose(), bearing.cross(first).transpose();
  return basis;
}

}  // namespace

std::vector<Sight> SightsOf(const Place& a, const Place& b, const std::vector<FeatureMatch>& matches) {
  std::vector<Sight> sights;
  for (size_t i = 0; i < matches.size(); ++i) {
    const PlaceFeature &in_a = a.features[matches[i].a], &in_b = b.features[matches[i].b];
    const auto add = [&](bool is_forward, const PlaceFeature& ray, const PlaceFeature& seen) {
      if (!seen.point) return;
      const double distance = (*seen.point - seen.origin).norm();
      sights.push_back({is_forward, i, kCamerasPerPlace * in_a.camera + in_b.camera, ray.origin, ray.bearing,
                        *seen.point, seen.origin, ray.sigma, distance * seen.sigma, seen.depth_sigma});
    };
    add(true, in_a, in_b);
    add(false, in_b, in_a);
  }
  return sights;
}

SightError ErrorOf(const Sight& sight, const Rigid3& a_from_b) {
  const Eigen::Matrix3d rotation = a_from_b.rotation.toRotationMatrix();
  Eigen::Vector3d view, seen_along;  // to the point from the ray's origin; the line of sight that made the point
  Eigen::Matrix<double, 3, 6> by_tangent;
  if (sight.is_forward) {
    view = a_from_b * sight.point - sight.origin;
    seen_along = rotation * (sight.point - sight.point_origin);
    by_tangent << rotation, -rotation * Skew(sight.point);
  } else {
    const Eigen::Vector3d in_b = a_from_b.Inverse() * sight.point;
    view = in_b - sight.origin;
    seen_along = rotation.transpose() * (sight.point - sight.point_origin);
    by_tangent << -Eigen::Matrix3d::Identity(), Skew(in_b);
  }
  const double distance = std::max(view.norm(), 0.1);
  const double across = view.cross(seen_along).norm() / (distance * std::max(seen_along.norm(), 1e-6));
  const double sigma =
      std::sqrt(std::pow(sight.ray_sigma, 2) +
                (std::pow(sight.point_sigma, 2) + std::pow(across * sight.depth_sigma, 2)) / (distance * distance));
  const Eigen::Matrix<double, 2, 3> basis = BasisAcross(sight.bearing) / (distance * sigma);
  return {basis * view, basis * by_tangent, sight.bearing.dot(view) > 0.1};
}

std::vector<Rigid3> SolveUprightPose(const Sight& first, const Sight& second) {
  // With c, s the cosine and sine of yaw: across(bearing) * (c u + s w + t) = across(bearing) * (origin - z e_z).
  Eigen::Matrix<double, 4, 5> left;
  Eigen::Vector4d right;
  const Sight* const sights[] = {&first, &second};
  for (int i = 0; i < 2; ++i) {
    const Sight& sight = *sights[i];
    const Eigen::Matrix<double, 2, 3> across = BasisAcross(sight.bearing);
    const Eigen::Vector3d& point = sight.point;
    left.middleRows<2>(2 * i).col(0) = across * Eigen::Vector3d(point.x(), point.y(), 0);
    left.middleRows<2>(2 * i).col(1) = across * Eigen::Vector3d(-point.y(), point.x(), 0);
    left.middleRows<2>(2 * i).rightCols<3>() = across;
    right.segment<2>(2 * i) = across * (sight.origin - Eigen::Vector3d(0, 0, point.z()));
  }
  const Eigen::JacobiSVD<Eigen::Matrix<double, 4, 5>> svd(left, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.singularValues()[3] < 1e-6 * svd.singularValues()[0]) return {};
  const Eigen::Matrix<double, 5, 1> base = svd.solve(right), free = svd.matrixV().col(4);
  // |(c, s)| = 1 along base + x free.
  const double a = free.head<2>().squaredNorm(), b = 2 * base.head<2>().dot(free.head<2>()),
               c = base.head<2>().squaredNorm() - 1;
  const double discriminant = b * b - 4 * a * c;
  if (a < 1e-12 || discriminant < 0) return {};
  std::vector<Rigid3> poses;
  for (const double sign : {-1.0, 1.0}) {
    const Eigen::Matrix<double, 5, 1> solution = base + (-b + sign * std::sqrt(discriminant)) / (2 * a) * free;
    const Rigid3 pose{ExpSo3({0, 0, std::atan2(solution[1], solution[0])}), solution.tail<3>()};
    poses.push_back(first.is_forward ? pose : pose.Inverse());
  }
  return poses;
}

}  // namespace parkade
