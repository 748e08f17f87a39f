#pragma once

#include "tests/simulator/render/scene_surfaces.h"

namespace parkade::simulator {

/// The sun on what an image shows, with the shadows of the world, of what moves, and of the own
/// car.
class Sunlight {
 public:
  /// Keeps references. `own_car` holds the own car alone, in body.
  Sunlight(const Scene& scene, const SceneSurfaces& surfaces, const RayScene& own_car);

  /// Whether neither the world nor what moves hides the sun from an eye; the own car is not asked.
  /// `time`: 0..1 over the image.
  bool Shines(const Eigen::Vector3f& eye, float time) const;

  /// Sets SurfacePoint::sun of the lanes that are a surface.
  void FallOn(const PacketPoses& poses, const LaneFlags& is_surface, SurfacePoints& points) const;

 private:
  const Scene& scene_;
  const SceneSurfaces& surfaces_;
  const RayScene& own_car_;
  std::array<Eigen::Vector3f, kSamplesPerPixel> to_sun_;
};

}  // namespace parkade::simulator
