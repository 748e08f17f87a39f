#pragma once

#include <optional>
#include <vector>

#include "core/trajectory.h"
#include "mapping/ground/repeated_passes.h"

namespace parkade {

/// Chooses the images worth mapping: per camera one for every stretch of travel, none at standstill
/// but the first. An image is taken where waiting for the next one would overshoot the stretch by
/// more than it falls short. Decides by the pose alone, before anything is decoded. Ask in order of
/// time per camera; asking again for the time just asked for (its mask) answers the same. Not
/// thread-safe.
class KeyframePicker {
 public:
  /// The trajectory is borrowed.
  /// \param stretch  [m] of travel
  /// \param turn     [rad], or so much turning
  /// \param repeated  where none is taken; borrowed, may be null
  KeyframePicker(const Trajectory& odom_from_body, size_t num_cameras, double stretch, double turn,
                 const RepeatedPasses* repeated = nullptr);

  /// False outside the trajectory.
  bool Wants(int camera, Timestamp time);

 private:
  struct Image {
    Timestamp time;
    Rigid3 odom_from_body;
    bool is_chosen = false;
  };
  struct Camera {
    std::optional<Image> last_chosen, last;
  };
  bool IsStretchOver(const Camera& camera, const Rigid3& odom_from_body) const;

  const Trajectory* odom_from_body_;
  const RepeatedPasses* repeated_;
  double stretch_, turn_;
  std::vector<Camera> cameras_;
};

}  // namespace parkade
