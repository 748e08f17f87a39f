#include "mapping/kerbs/samples_around.h"

#include <numeric>

namespace parkade {

using Eigen::Vector2d;
using Eigen::Vector3d;

SamplesAround::SamplesAround(const PosedGroundPatch& posed, const Vector3d& eye)
    : eye_(eye), samples_(posed.patch.samples.size()), begin_of_(kNumSectors + 1) {
  std::vector<Sample> unsorted;
  unsorted.reserve(samples_.size());
  for (const GroundSample& sample : posed.patch.samples) {
    const Vector3d ray = posed.site_from_body * sample.point_in_body.cast<double>() - eye;
    unsorted.push_back(
        {DirectionOf(ray.x(), ray.y()), ray.cast<float>(),
         static_cast<float>(114 * sample.blue + 587 * sample.green + 299 * sample.red) / 1000});
    ++begin_of_[SectorOf(unsorted.back().direction) + 1];
  }
  std::partial_sum(begin_of_.begin(), begin_of_.end(), begin_of_.begin());
  std::vector<std::ptrdiff_t> next = begin_of_;
  for (const Sample& sample : unsorted)
    samples_[static_cast<std::size_t>(next[SectorOf(sample.direction)]++)] = sample;
}

std::pair<double, double> SamplesAround::Between(std::span<const Vector2d> places) const {
  const auto azimuth_of = [&](const Vector2d& place) {
    const Vector2d ray = place - eye_.head<2>();
    return std::atan2(ray.y(), ray.x());
  };
  const double first = azimuth_of(places.front());
  double from = first, to = first;
  for (const Vector2d& place : places) {
    const double azimuth = first + std::remainder(azimuth_of(place) - first, 2 * M_PI);
    from = std::min(from, azimuth), to = std::max(to, azimuth);
  }
  if (to - from >= M_PI) from = first - M_PI, to = first + M_PI;
  return {from, to};
}

}  // namespace parkade
