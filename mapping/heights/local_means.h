#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "core/ground_patch.h"

namespace parkade {

/// Which samples are asked what the ground looks like.
enum class UsedSamples {
  kFree,  ///< drivable ground
  kSeen   ///< also pavements, lawns and what nobody can tell, but for what bounds the ground hides
};

/// What is usual around a sample of the ground in its own image. Taken off, it makes exposures and
/// shades agree. It is smooth, and its squares lie on the car's plane, where the car carries them
/// along: a mean that hung on the surface, or that jumped from window to window, would jump at the
/// same places in all views as long as the surface stays where it is, and views would agree best
/// there, right or wrong.
class LocalMeans {
 public:
  /// The samples are borrowed. \param along, across  [m] of its squares, in the direction that the
  /// car looks and across
  LocalMeans(const std::vector<GroundSample>& samples, double along, double across,
             UsedSamples used = UsedSamples::kFree);

  /// What a sample counts for; 0: it is not used.
  float WeightOf(const GroundSample& sample) const {
    constexpr float kDoubtful = 0.3F;
    if (used_ == UsedSamples::kFree) return sample.is_free ? float{sample.confidence} : 0;
    return sample.IsBeyond() ? 0 : std::max(float{sample.confidence}, kDoubtful);
  }
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

  UsedSamples used_;
  Eigen::Array2f per_square_;                    ///< [1/m]
  Eigen::Array2f low_ = Eigen::Array2f::Zero();  ///< [squares] corner; a rim of one square around
                                                 ///< all samples
  int width_ = 0;
  std::vector<Eigen::Array2f> sums_;  ///< of weights, and of weighted gray values
};

}  // namespace parkade
