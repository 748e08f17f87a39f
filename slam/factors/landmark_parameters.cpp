#include "slam/factors/landmark_parameters.h"

#include <Eigen/Geometry>

#include "slam/factors/measurement_model.h"

namespace parkade {

LandmarkRay::LandmarkRay(const Eigen::Vector3d& origin_in_odom,
                         const Eigen::Vector3d& direction_in_odom)
    : origin(origin_in_odom),
      direction(direction_in_odom.normalized()),
      basis(BasisAcross(direction)) {}

void Rebase(LandmarkRay& ray, double* landmark) {
  if (!(Eigen::Map<const Eigen::Vector2d>(landmark).norm() > kMaxLandmarkTangent)) return;
  const Eigen::Vector3d moved = ray.Ray(landmark);
  landmark[0] = landmark[1] = 0;
  landmark[2] /= moved.norm();
  ray = LandmarkRay(ray.origin, moved);
}

Eigen::Matrix<double, 3, 2> BasisAcross(const Eigen::Vector3d& direction) {
  int smallest = 0;
  direction.cwiseAbs().minCoeff(&smallest);
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.cross(Eigen::Vector3d::Unit(smallest)).normalized();
  basis.col(1) = direction.cross(basis.col(0));
  return basis;
}

}  // namespace parkade
