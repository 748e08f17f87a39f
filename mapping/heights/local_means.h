#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/ground_patch.h"

namespace parkade {

/// What is usual around a sample of the ground in its own image. Taken off, it makes exposures and
/// shades agree. It is smooth, and its squares lie on the car's plane, where the car carries them
/// along: a mean that hung on the surface, or that jumped from window to window, would jump at the
/// same places in all views as long as the surface stays where it is, and views would agree best
/// there, right or wrong.
class LocalMeans {
 public:
  /// The samples are borrowed. \param square  [m] side
  LocalMeans(const std::vector<GroundSample>& samples, double square);

  /// Only free ground shows what the ground looks like.
  static bool IsUsed(const GroundSample& sample) { return sample.is_free && sample.confidence > 0; }
  static float GrayOf(const GroundSample& sample) {
    return (114.0F * sample.blue + 587.0F * sample.green + 299.0F * sample.red) / 1000;
  }

  /// Around one of the samples that are used: bilinear between the middles of squares.
  float At(const GroundSample& sample) const;

 private:
  Eigen::Array2f PlaceOf(const GroundSample& sample) const {
    return per_square_ * Eigen::Array2f(sample.point_in_body.x(), sample.point_in_body.y()) - low_;
  }
  std::size_t IndexOf(const Eigen::Array2i& square) const {
    return static_cast<std::size_t>(square.y() * width_ + square.x());
  }

  float per_square_;                             ///< [1/m]
  Eigen::Array2f low_ = Eigen::Array2f::Zero();  ///< [squares] corner; a rim of one square around
                                                 ///< all samples
  int width_ = 0;
  std::vector<Eigen::Array2f> sums_;  ///< of weights, and of weighted gray values
};

}  // namespace parkade
