#pragma once

#include <Eigen/Core>

#include "tests/simulator/common/color.h"

namespace parkade::simulator {

/// Irradiance of the own car's dipped headlights on a surface; nothing shades them.
/// Point [m] and unit normal in body.
Color HeadlightIrradiance(const Eigen::Vector3f& point_in_body,
                          const Eigen::Vector3f& normal_in_body);

}  // namespace parkade::simulator
