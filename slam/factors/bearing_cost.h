#pragma once

#include <ceres/cost_function.h>

#include <vector>

#include "slam/factors/camera_parameters.h"
#include "slam/factors/image_pose.h"
#include "slam/factors/landmark_parameters.h"

namespace parkade {

/// One image in a graph: its camera, the nodes around it, and its pose, evaluated once per step for
/// all the bearings in it (see FactorGraph).
struct ImageView {
  NodeInterpolation interpolation;
  double* first_pose = nullptr;   ///< parameter block of the node before
  double* second_pose = nullptr;  ///< of the node after; null: the image is at the first node
  double* extrinsics = nullptr;   ///< parameter block of the camera
  double* timing = nullptr;       ///< parameter block of the camera
  double time_offset = 0;         ///< [s] with which `interpolation` was made
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< [rad/s] in imu, held fixed
  Eigen::Vector3d velocity_in_odom = Eigen::Vector3d::Zero();  ///< [m/s] of the imu, held fixed

  bool holds_time_offset = false;  ///< not estimated
  bool holds_line_delay = false;   ///< not estimated

  ImagePose pose;
  Eigen::Matrix3d camera_from_imu = Eigen::Matrix3d::Identity();
  Eigen::Vector3d camera_in_imu = Eigen::Vector3d::Zero();  ///< [m]

  /// The parameter blocks on which bearings in this image depend, in the order of a BearingCost.
  std::vector<double*> Blocks() const;

  /// Recomputes the pose and the camera's from the parameter blocks.
  void Update();

  /// [s] by which what is seen `row` rows below the middle was seen later than `pose`.
  double Delay(double row) const { return timing[0] - time_offset + row * timing[1]; }
  /// odom_from_camera when that row was exposed.
  Rigid3 OdomFromCamera(double row) const;
};

/// Measured bearing, with what residuals need of it.
struct Bearing {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, in the camera frame
  Eigen::Matrix<double, 3, 2> basis;                     ///< across it
  double sigma = 1;                                      ///< [rad]
  double row = 0;                                        ///< [px] below the middle of the image

  Bearing(const Eigen::Vector3d& unit_direction, double sigma_rad, double row_from_middle = 0)
      : direction(unit_direction),
        basis(BasisAcross(unit_direction)),
        sigma(sigma_rad),
        row(row_from_middle) {}
};

/// Direction of a landmark in the camera of `view` when `row` was exposed, not
/// normalized, at the view's current pose.
Eigen::Vector3d LandmarkInCamera(const ImageView& view, const LandmarkRay& ray,
                                 const double* landmark, double row);

/// The bearing is further off the landmark than kMaxBearingError, or the landmark is behind.
bool IsOutlier(const ImageView& view, const LandmarkRay& ray, const double* landmark,
               const Bearing& bearing);

/// Bearing of a landmark in an image (2 values), on the plane tangent to the
/// measured bearing z, valid for any angle from the optical axis:
///
///   d = R_IC^T (R(t)^T (ray + w (origin - p(t))) - w p_IC),   r = B(z)^T d / |d| / sigma
///   t = stamp + offset + row line_delay
///
/// w: inverse distance. Within the image, R and p go on with the angular velocity and the
/// velocity of the view. Parameter blocks: first_pose 7, [second_pose 7,] extrinsics 7,
/// timing 2, landmark 3. Reads poses from `view`, which must be up to date
/// (ImageView::Update); `view` and `ray` are borrowed.
class BearingCost final : public ceres::CostFunction {
 public:
  BearingCost(const ImageView* view, const LandmarkRay* ray, const Bearing& bearing);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  struct Derivatives;
  void FillPoses(const Derivatives& by, double** jacobians) const;
  void FillCamera(const Derivatives& by, double** jacobians) const;

  const ImageView* view_;
  const LandmarkRay* ray_;
  Bearing bearing_;
};

}  // namespace parkade
