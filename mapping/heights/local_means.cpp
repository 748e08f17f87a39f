#include "mapping/heights/local_means.h"

#include <Eigen/Geometry>
#include <cmath>

namespace parkade {

LocalMeans::LocalMeans(const std::vector<GroundSample>& samples, double along, double across,
                       UsedSamples used)
    : used_(used), per_square_(static_cast<float>(1 / along), static_cast<float>(1 / across)) {
  Eigen::AlignedBox2f box;
  for (const GroundSample& sample : samples)
    if (WeightOf(sample) > 0) box.extend(PlaceOf(sample).matrix());
  if (box.isEmpty()) return;
  low_ = box.min().array().floor() - 1;
  width_ = static_cast<int>(std::floor(box.max().x()) - low_.x()) + 2;
  const int height = static_cast<int>(std::floor(box.max().y()) - low_.y()) + 2;
  sums_.resize(static_cast<std::size_t>(width_ * height), Eigen::Array2f::Zero());
  for (const GroundSample& sample : samples)
    if (const float weight = WeightOf(sample); weight > 0)
      sums_[IndexOf(PlaceOf(sample).cast<int>())] += weight * Eigen::Array2f(1, GrayOf(sample));
}

float LocalMeans::At(const GroundSample& sample) const {
  const Eigen::Array2f place = PlaceOf(sample) - 0.5F;
  const Eigen::Array2i corner = place.cast<int>();
  const Eigen::Array2f part = place - corner.cast<float>();
  const std::size_t below = IndexOf(corner), above = below + static_cast<std::size_t>(width_);
  const Eigen::Array2f sum =
      (1 - part.y()) * ((1 - part.x()) * sums_[below] + part.x() * sums_[below + 1]) +
      part.y() * ((1 - part.x()) * sums_[above] + part.x() * sums_[above + 1]);
  return sum.y() / sum.x();
}

}  // namespace parkade
