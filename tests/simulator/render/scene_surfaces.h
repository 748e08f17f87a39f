#pragma once

#include <vector>

#include "tests/simulator/rays/ray_scene.h"
#include "tests/simulator/render/ray_packet.h"
#include "tests/simulator/scenes/mover_scene.h"

namespace parkade::simulator {

/// All that rays meet but the own car: the world as it stands, with the light of sky, lamps and
/// walls baked into its vertices, and what moves in it. Between two PlaceMovers calls tracing is
/// thread-safe.
class SceneSurfaces {
 public:
  /// Keeps a reference to `scene`. Bakes light, on all cores: seconds.
  explicit SceneSurfaces(const Scene& scene);

  /// See MoverScene::PlaceAt.
  void PlaceMovers(double from, double to, const Eigen::Vector3d& eye) {
    movers_.PlaceAt(from, to, eye);
  }
  const MoverScene& movers() const { return movers_; }

  /// Shoots rays at the world and the movers; tells which lanes hit a mover. `valid`: -1 for lanes
  /// in use, else 0.
  LaneFlags Trace(const int* valid, RTCRayHit16& hits) const;
  /// Makes tfar negative in the lanes that something hides.
  void Occlude(const int* valid, RTCRay16& rays) const;

  /// The surface that a lane has hit.
  SurfacePoint PointOfHit(const RTCRayHit16& hits, int lane, bool is_mover) const;

 private:
  void BakeLight();
  SurfacePoint PointInWorld(const RTCRayHit16& hits, int lane) const;
  SurfacePoint PointOnMover(const RTCRayHit16& hits, int lane) const;

  const Scene& scene_;
  RayScene world_;
  /// Values of ground and objects, per vertex: the share of sky, and the light of lamps and walls.
  std::array<std::vector<float>, 2> ambient_;
  std::array<std::vector<Color>, 2> light_;
  MoverScene movers_;
};

}  // namespace parkade::simulator
