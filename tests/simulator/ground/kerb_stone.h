#pragma once

#include <Eigen/Core>

namespace parkade::simulator {

/// One stone of a kerb.
struct KerbStone {
  Eigen::Vector3d begin,
      end;            ///< [m] in world: the foot of its front on the ground, which lies on the left
  double height = 0;  ///< [m] of its top above that
};

}  // namespace parkade::simulator
