#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "mapping/heights/height_field.h"

namespace parkade {

/// Where the ray from `eye` through `point` meets the surface: its patch, and `point` is moved
/// there. kNone where it does not, or at so grazing an angle that it cannot be trusted.
int IntersectRay(PatchFinder& patches, const Eigen::Vector3d& eye, Eigen::Vector3d& point);

constexpr double kLookMargin =
    1.0;  ///< [m] from the ends of a ray nothing is looked for that hides
constexpr double kHidingHeight = 0.1;  ///< [m] above a ray: what hides
constexpr double kHidingSigma = 0.05;  ///< [m] of ground that hides what is behind it

/// Whether ground that is well known stands in the way from `eye` to `point` [m], as the foot of a
/// ramp does before the deck that is continued below it. Looks every 0.8 m.
bool IsHidden(const HeightField& field, const Eigen::Vector3d& eye, const Eigen::Vector3d& point);

}  // namespace parkade
