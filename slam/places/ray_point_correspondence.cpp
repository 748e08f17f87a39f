#include "slam/places/ray_point_correspondence.h"

#include <Eigen/SVD>

namespace parkade {
namespace {

/// Two unit vectors perpendicular to `bearing`, as rows.
Eigen::Matrix<double, 2, 3> RowsAcross(const Eigen::Vector3d& bearing) {
  const Eigen::Vector3d first = bearing.unitOrthogonal();
  Eigen::Matrix<double, 2, 3> basis;
  basis << first.transpose(), bearing.cross(first).transpose();
  return basis;
}

/// A correspondence at a pose, in the keyframe of its ray.
struct View {
  Eigen::Matrix3d ray_from_point;  ///< rotation from the point's keyframe
  Eigen::Vector3d to_point;        ///< [m] from the ray's origin
  Eigen::Matrix<double, 2, 3> whitening;

  Eigen::Vector2d Whitened() const { return whitening * to_point; }
  bool IsInFront(const RayPointCorrespondence& correspondence) const {
    return correspondence.bearing.dot(to_point) > 0.1;
  }
};

View ViewOf(const RayPointCorrespondence& correspondence, const Rigid3& a_from_b) {
  const Rigid3 ray_from_point = correspondence.is_forward ? a_from_b : a_from_b.Inverse();
  View view{ray_from_point.rotation.toRotationMatrix(),
            ray_from_point * correspondence.point - correspondence.origin,
            {}};
  const Eigen::Vector3d seen_along =
      view.ray_from_point * (correspondence.point - correspondence.point_origin);
  const double distance = std::max(view.to_point.norm(), 0.1);
  const double across =
      view.to_point.cross(seen_along).norm() / (distance * std::max(seen_along.norm(), 1e-6));
  const double sigma = std::sqrt(
      std::pow(correspondence.ray_sigma, 2) +
      (std::pow(correspondence.point_sigma, 2) + std::pow(across * correspondence.depth_sigma, 2)) /
          (distance * distance));
  view.whitening = RowsAcross(correspondence.bearing) / (distance * sigma);
  return view;
}

}  // namespace

std::vector<RayPointCorrespondence> CorrespondencesOf(const RigKeyframe& a, const RigKeyframe& b,
                                                      const std::vector<FeatureMatch>& matches) {
  std::vector<RayPointCorrespondence> correspondences;
  for (size_t i = 0; i < matches.size(); ++i) {
    const KeyframeFeature &in_a = a.features[matches[i].a], &in_b = b.features[matches[i].b];
    const auto add = [&](bool is_forward, const KeyframeFeature& ray, const KeyframeFeature& seen) {
      if (!seen.point) return;
      const double distance = (*seen.point - seen.origin).norm();
      correspondences.push_back({is_forward, i, kCamerasPerKeyframe * in_a.camera + in_b.camera,
                                 ray.origin, ray.bearing, *seen.point, seen.origin, ray.sigma,
                                 distance * seen.sigma, seen.depth_sigma});
    };
    add(true, in_a, in_b);
    add(false, in_b, in_a);
  }
  return correspondences;
}

bool IsInlier(const RayPointCorrespondence& correspondence, const Rigid3& a_from_b,
              double max_error) {
  const View view = ViewOf(correspondence, a_from_b);
  return view.IsInFront(correspondence) && view.Whitened().norm() < max_error;
}

CorrespondenceError ErrorOf(const RayPointCorrespondence& correspondence, const Rigid3& a_from_b) {
  const View view = ViewOf(correspondence, a_from_b);
  Eigen::Matrix<double, 3, 6> by_tangent;
  if (correspondence.is_forward) {
    by_tangent << view.ray_from_point, -view.ray_from_point * Skew(correspondence.point);
  } else {
    by_tangent << -Eigen::Matrix3d::Identity(), Skew(view.to_point + correspondence.origin);
  }
  return {view.Whitened(), view.whitening * by_tangent, view.IsInFront(correspondence)};
}

MountJacobians MountJacobiansOf(const RayPointCorrespondence& correspondence,
                                const Rigid3& a_from_b) {
  const View view = ViewOf(correspondence, a_from_b);
  const int camera_of_a = correspondence.camera_pair / kCamerasPerKeyframe,
            camera_of_b = correspondence.camera_pair % kCamerasPerKeyframe;
  MountJacobians jacobians;
  jacobians.ray_camera = correspondence.is_forward ? camera_of_a : camera_of_b;
  jacobians.point_camera = correspondence.is_forward ? camera_of_b : camera_of_a;
  // A mount that rotates the ray rotates the view back; a point moves with the camera that saw it.
  jacobians.by_ray << -view.whitening, view.whitening * Skew(view.to_point);
  jacobians.by_point << view.whitening * view.ray_from_point,
      -view.whitening * view.ray_from_point *
          Skew(correspondence.point - correspondence.point_origin);
  return jacobians;
}

std::vector<Rigid3> SolveUprightPose(const RayPointCorrespondence& first,
                                     const RayPointCorrespondence& second) {
  // With c, s the cosine and sine of yaw: across(bearing) * (c u + s w + t) = across(bearing) *
  // (origin - z e_z).
  Eigen::Matrix<double, 4, 5> left;
  Eigen::Vector4d right;
  const RayPointCorrespondence* const correspondences[] = {&first, &second};
  for (int i = 0; i < 2; ++i) {
    const RayPointCorrespondence& correspondence = *correspondences[i];
    const Eigen::Matrix<double, 2, 3> across = RowsAcross(correspondence.bearing);
    const Eigen::Vector3d& point = correspondence.point;
    left.middleRows<2>(2 * i).col(0) = across * Eigen::Vector3d(point.x(), point.y(), 0);
    left.middleRows<2>(2 * i).col(1) = across * Eigen::Vector3d(-point.y(), point.x(), 0);
    left.middleRows<2>(2 * i).rightCols<3>() = across;
    right.segment<2>(2 * i) = across * (correspondence.origin - Eigen::Vector3d(0, 0, point.z()));
  }
  const Eigen::JacobiSVD<Eigen::Matrix<double, 4, 5>> svd(
      left, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.singularValues()[3] < 1e-6 * svd.singularValues()[0]) return {};
  const Eigen::Matrix<double, 5, 1> base = svd.solve(right), free = svd.matrixV().col(4);
  // |(c, s)| = 1 along base + x free.
  const double a = free.head<2>().squaredNorm(), b = 2 * base.head<2>().dot(free.head<2>()),
               c = base.head<2>().squaredNorm() - 1;
  const double discriminant = b * b - 4 * a * c;
  if (a < 1e-12 || discriminant < 0) return {};
  std::vector<Rigid3> poses;
  for (const double sign : {-1.0, 1.0}) {
    const Eigen::Matrix<double, 5, 1> solution =
        base + (-b + sign * std::sqrt(discriminant)) / (2 * a) * free;
    const Rigid3 pose{ExpSo3({0, 0, std::atan2(solution[1], solution[0])}), solution.tail<3>()};
    poses.push_back(first.is_forward ? pose : pose.Inverse());
  }
  return poses;
}

}  // namespace parkade
