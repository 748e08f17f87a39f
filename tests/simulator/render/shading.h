#pragma once

#include <vector>

#include "tests/simulator/scenes/scene.h"

namespace parkade::simulator {

/// A point of a surface, as one ray sees it. World frame.
struct SurfacePoint {
  Eigen::Vector3f position, normal, flat_normal,
      ray;                    ///< unit vectors; the ray runs toward the surface
  float distance = 0;         ///< [m] along the ray
  float sample_angle = 0;     ///< [rad] between neighboring rays
  float motion = 0;           ///< [m] that the surface is smeared while this ray gathers light
  float ambient = 1;          ///< share of the sky that is not hidden
  Color light = Gray(0);      ///< irradiance of lamps and from lit walls
  Color reflected = Gray(0);  ///< radiance that a wet or sealed ground mirrors
  float openness = 1;         ///< 0 deep inside a building, where no sky is mirrored
  float sun = 0;              ///< share of the sun that is not hidden, times the cosine
  bool is_ground = false;     ///< `material` counts Scene::ground_colors
  MaterialId material = 0;
};

/// How a wet or sealed ground mirrors at a point: the share of light, 0..1.
float GroundMirror(const Scene& scene, const SurfacePoint& point);

/// Radiance toward the eye.
Color Shade(const Scene& scene, const SurfacePoint& point);

}  // namespace parkade::simulator
