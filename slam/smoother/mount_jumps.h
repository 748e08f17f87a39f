#pragma once

#include <optional>
#include <vector>

#include "slam/smoother/node_conditional.h"
#include "slam/smoother/smoother_window.h"

namespace parkade {

/// A camera whose mount turned at once: a mirror folded, a door opened.
struct CameraJump {
  Timestamp time;  ///< of its first image after that
  int camera = 0;
  double angle = 0;  ///< [rad]
};

struct MountJump {
  CameraJump jump;
  std::optional<StateConditional> reopened;  ///< the extrinsics before it, where estimated
};

/// Looks among the views from `first_new_view` on for a camera that sees its landmarks turned while
/// the others do not; drops its older images and opens its extrinsics in the prior anew.
std::vector<MountJump> FindMountJumps(size_t first_new_view, SmootherWindow& window);

}  // namespace parkade
