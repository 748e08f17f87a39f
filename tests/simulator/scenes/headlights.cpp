#include "tests/simulator/scenes/headlights.h"

#include <cmath>

namespace parkade::simulator {

Color HeadlightIrradiance(const Eigen::Vector3f& point_in_body,
                          const Eigen::Vector3f& normal_in_body) {
  constexpr float kStrength = 7;
  if (point_in_body.x() < 3.2f || point_in_body.x() > 35) return Gray(0);
  float sum = 0;
  for (const float side : {-0.6f, 0.6f}) {
    const Eigen::Vector3f away = point_in_body - Eigen::Vector3f(3.1f, side, 0.66f);
    const float squared = away.squaredNorm(), distance = std::sqrt(squared);
    const float facing = -normal_in_body.dot(away) / distance;
    if (facing <= 0) continue;
    const float aside = away.y() / away.x(), above = away.z() / away.x() + 0.07f;
    const float up = above > 0 ? above / 0.035f : above / 0.16f;  // they must not dazzle
    sum += facing / squared * std::exp(-aside * aside / 0.16f - up * up);
  }
  return Rgb(1.0f, 0.95f, 0.85f) * (kStrength * sum);
}

}  // namespace parkade::simulator
