#pragma once

#include <Eigen/Core>

namespace parkade {

inline constexpr int kNumRayDirections = 256;

/// The direction of a ray: which of kNumRayDirections parts of a turn from -pi on its angle lies
/// in. Exactly what std::atan2 says, at a third of its time where rays come in order.
int DirectionOf(const Eigen::Vector2d& ray);

}  // namespace parkade
