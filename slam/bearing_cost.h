#pragma once

#include <ceres/cost_function.h>

#include "slam/first_estimate.h"
#include "slam/image_pose.h"
#include "slam/landmark_parameters.h"

namespace parkade {

/// One image in the window: its camera, the knots around it, and its pose,
/// evaluated once per step for all the bearings in it (see
/// WindowEvaluationCallback).
struct ImageView {
  Rigid3 imu_from_camera;
  KnotInterpolation interpolation;
  const double* first_pose = nullptr;              ///< parameter block of the knot before
  const double* second_pose = nullptr;             ///< of the knot after; null: the image is at the first knot
  const FirstEstimate* first_estimate = nullptr;   ///< may be null
  const FirstEstimate* second_estimate = nullptr;  ///< may be null
  ImagePose current;                               ///< where residuals are evaluated
  ImagePose linearised;                            ///< where Jacobians are evaluated
  bool is_at_first_estimate = false;               ///< the two differ

  /// Recomputes both poses from the parameter blocks.
  void Update();
};

/// Direction of a landmark in the camera of `view`, not normalised, at the
/// view's current pose.
Eigen::Vector3d LandmarkInCamera(const ImageView& view, const LandmarkRay& ray, const double* landmark);

/// Measured bearing, with what residuals need of it.
struct Bearing {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, in the camera frame
  Eigen::Matrix<double, 3, 2> basis;                     ///< across it
  double sigma = 1;                                      ///< [rad]

  Bearing(const Eigen::Vector3d& unit_direction, double sigma_rad)
      : direction(unit_direction), basis(BasisAcross(unit_direction)), sigma(sigma_rad) {}
};

/// Bearing of a landmark in an image (2 values), on the plane tangent to the
/// measured bearing z, valid for any angle from the optical axis:
///
///   d = R_IC^T (R(t)^T (ray + w (origin - p(t))) - w p_IC),   r = B(z)^T d / |d| / sigma
///
/// w: inverse distance. Parameter blocks: first_pose 7, [second_pose 7,]
/// landmark 3. Held fixed: extrinsics. Reads the image's pose from `view`, which
/// must be up to date (ImageView::Update); `view` and `ray` are borrowed.
class BearingCost final : public ceres::CostFunction {
 public:
  BearingCost(const ImageView* view, const LandmarkRay* ray, const Bearing& bearing);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const ImageView* view_;
  const LandmarkRay* ray_;
  Bearing bearing_;
};

}  // namespace parkade
