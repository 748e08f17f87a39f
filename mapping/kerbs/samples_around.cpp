#include "mapping/kerbs/samples_around.h"

#include <numeric>

namespace parkade {

using Eigen::Vector2d;
using Eigen::Vector3d;

SamplesAround::SamplesAround(const PosedGroundPatch& posed, const Vector3d& eye,
                             std::span<const GroundArea> areas)
    : eye_(eye), begin_of_(kNumSectors + 1) {
  std::array<bool, kNumSectors> is_wanted{};
  for (const GroundArea& area : areas)
    ForEachRange(area, [&](float lowest, float highest) {
      std::fill(is_wanted.begin() + SectorOf(lowest), is_wanted.begin() + SectorOf(highest) + 1,
                true);
    });
  std::vector<Sample> unsorted;
  unsorted.reserve(posed.patch.samples.size());
  const Eigen::Matrix3d rotation = posed.site_from_body.rotation.toRotationMatrix();
  const Vector3d from_eye = posed.site_from_body.translation - eye;
  for (const GroundSample& sample : posed.patch.samples) {
    const Vector3d ray = rotation * sample.point_in_body.cast<double>() + from_eye;
    const float direction = DirectionOf(ray.x(), ray.y());
    const std::size_t sector = SectorOf(direction);
    if (!is_wanted[sector]) continue;
    unsorted.push_back(
        {direction, ray.cast<float>(),
         static_cast<float>(114 * sample.blue + 587 * sample.green + 299 * sample.red) / 1000});
    ++begin_of_[sector + 1];
  }
  std::partial_sum(begin_of_.begin(), begin_of_.end(), begin_of_.begin());
  std::vector<std::ptrdiff_t> next = begin_of_;
  samples_.resize(unsorted.size());
  for (const Sample& sample : unsorted)
    samples_[static_cast<std::size_t>(next[SectorOf(sample.direction)]++)] = sample;
}

std::pair<double, double> SamplesAround::AzimuthsOf(const GroundArea& area) const {
  const auto azimuth_of = [&](const Vector2d& corner) {
    const Vector2d ray = corner - eye_.head<2>();
    return std::atan2(ray.y(), ray.x());
  };
  const double first = azimuth_of(area.front());
  double from = first, to = first;
  for (const Vector2d& corner : area) {
    const double azimuth = first + std::remainder(azimuth_of(corner) - first, 2 * M_PI);
    from = std::min(from, azimuth), to = std::max(to, azimuth);
  }
  if (to - from >= M_PI) from = first - M_PI, to = first + M_PI;
  return {from, to};
}

}  // namespace parkade
