#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <vector>

#include "tests/simulator/common/lamp.h"
#include "tests/simulator/common/mesh.h"

namespace parkade::simulator {

/// Gives a copy of `mesh` to an Embree scene.
void AttachMesh(RTCDevice device, RTCScene scene, const Mesh& mesh, unsigned id);

/// Meshes that rays can be shot at: geometry ids count in the order given,
/// empty meshes included. Only
/// the .cpp files that trace rays include this. Tracing is thread-safe.
class RayScene {
 public:
  explicit RayScene(const std::vector<const Mesh*>& meshes);

  RTCScene scene() const { return scene_.get(); }

  /// `rounds` of 16 rays a vertex. Share of the sky that each vertex of `mesh` sees within `reach`
  /// [m], cosine-weighted, 0..1. In parallel, the same every time.
  std::vector<float> VertexAmbient(const Mesh& mesh, float reach, std::uint64_t seed,
                                   int rounds = 1) const;

  /// Irradiance of the lamps at each vertex of `mesh`, shadows included. In parallel.
  std::vector<Color> VertexLamps(const Mesh& mesh, const LampField& lamps) const;

 private:
  struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  };
  struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  std::unique_ptr<RTCDeviceTy, ReleaseDevice> device_;
  std::unique_ptr<RTCSceneTy, ReleaseScene> scene_;
};

/// Makes this thread treat tiny numbers as zero, which Embree wants, until the end of the scope.
class FlushDenormals {
 public:
  FlushDenormals();
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_;
};

}  // namespace parkade::simulator
