#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <vector>

#include "tests/simulator/common/fast_pose.h"
#include "tests/simulator/scenes/mover.h"

namespace parkade::simulator {

/// The movers at one stretch of time, for rays that carry a time within it. One image
/// at a time; between two PlaceAt calls tracing is thread-safe.
class MoverScene {
 public:
  explicit MoverScene(const Movers& movers);
  ~MoverScene();

  /// Places the movers that `eye` may see for [from, to] [s]; rays' time 0..1 runs over it.
  void PlaceAt(double from, double to, const Eigen::Vector3d& eye);

  bool empty() const { return placed_.empty(); }
  RTCScene scene() const { return top_.get(); }

  struct Placed {
    const Mover* mover;
    const Mesh* mesh;
    FastPose world_from_mover;  ///< in the middle of the stretch
  };
  /// By the instance id of a hit.
  const Placed& placed(unsigned instance) const { return placed_[instance]; }

  /// Share of the sky that the movers leave to a point of the ground.
  float Ambient(const Eigen::Vector3f& point) const;

 private:
  struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  };
  struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  using ScenePointer = std::unique_ptr<RTCSceneTy, ReleaseScene>;

  const Movers& movers_;
  std::unique_ptr<RTCDeviceTy, ReleaseDevice> device_;
  std::vector<ScenePointer> shapes_;
  ScenePointer top_;
  std::vector<Placed> placed_;
};

}  // namespace parkade::simulator
