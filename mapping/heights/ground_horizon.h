#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "mapping/heights/height_field.h"

namespace parkade {

/// How high well known ground stands around an eye, by direction and distance: one look tells of
/// most places that nothing hides them, without the walk of IsHidden along the ray.
class GroundHorizon {
 public:
  /// The horizon of the ground in a box; for places in it.
  /// \param eye  [m] in site
  GroundHorizon(const HeightField& field, const Eigen::Vector3d& eye,
                const Eigen::AlignedBox2d& box);

  /// False only where IsHidden(field, eye, point) is.
  bool MayHide(const Eigen::Vector3d& point_in_site) const;

 private:
  static int RingOf(double distance);
  void Raise(const Eigen::AlignedBox2d& square, double height);

  Eigen::Vector3d eye_;
  int num_rings_;
  std::vector<double> slopes_;  ///< sectors x rings: the steepest observation [rise per run] on
                                ///< ground in this ring or a nearer one; -infinity: none
};

}  // namespace parkade
