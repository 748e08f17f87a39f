#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "core/rig.h"

namespace parkade {

/// A camera's image on an upright cylinder around the car: columns are equal
/// angles about the upright axis, rows the tangent of the elevation. Upright things stand upright
/// in every camera's view, and cameras that look the same way see the same image, whatever their
/// lenses. No larger than what the lens sees, and a margin. Immutable, thread-safe.
class CylinderView {
 public:
  CylinderView() = default;  ///< sees nothing
  /// \param upright_from_body  turns the body's frame so that z is up where the car stands level
  CylinderView(const RigCamera& camera, const Eigen::Quaterniond& upright_from_body);

  /// Turns an image (CV_8UC1 of the calibrated size) into a view. Pixels that show nothing are 0.
  cv::Mat Warp(const cv::Mat& image) const;

  /// The view's mask: CV_8UC1, 0 where the lens or the rig's mask leaves nothing to see.
  const cv::Mat& usable() const { return usable_; }

  /// Unit bearing of a pixel of the view, in the upright frame.
  Eigen::Vector3d BearingInUpright(double column, double row) const;

  /// [px] where a usable pixel of the view lies in the image.
  Eigen::Vector2f ImagePoint(double column, double row) const;

  double pixels_per_radian() const { return scale_; }

 private:
  double scale_ = 1;    ///< [px/rad]
  double azimuth_ = 0;  ///< [rad] of column 0, growing to the left of the car
  double highest_ = 0;  ///< tangent of the elevation of row 0
  cv::Mat map_x_, map_y_, usable_;
};

}  // namespace parkade
