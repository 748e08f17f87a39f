#include "mapping/kerbs/samples_around.h"

#include <tuple>

namespace parkade {

using Eigen::Vector2d;
using Eigen::Vector3d;

SamplesAround::SamplesAround(const PosedGroundPatch& posed, const Vector3d& eye) : eye_(eye) {
  samples_.reserve(posed.patch.samples.size());
  for (const GroundSample& sample : posed.patch.samples) {
    const Vector3d ray = posed.site_from_body * sample.point_in_body.cast<double>() - eye;
    samples_.push_back(
        {std::atan2(ray.y(), ray.x()), ray.cast<float>(),
         static_cast<float>(114 * sample.blue + 587 * sample.green + 299 * sample.red) / 1000});
  }
  std::sort(samples_.begin(), samples_.end(), [](const Sample& a, const Sample& b) {
    return std::tie(a.azimuth, a.ray.x(), a.ray.y()) < std::tie(b.azimuth, b.ray.x(), b.ray.y());
  });
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
