#pragma once

#include <vector>

#include "tests/simulator/common/mesh.h"
#include "tests/simulator/common/random.h"

namespace parkade::simulator {

struct BuildingPlan {
  Eigen::Vector2d center;
  Eigen::Vector2d half_size;  ///< [m]
  double yaw = 0;
  double base = 0;          ///< [m] height of the ground
  double height = 8;        ///< [m]
  bool is_detailed = true;  ///< window frames, sills, doors; far ones do without
  bool is_lit = false;      ///< light in some windows
};

/// A block with rows of windows on all four sides; no two windows are alike.
void AddBuilding(const BuildingPlan& plan, Random& random, Mesh& mesh,
                 std::vector<Material>& materials);

}  // namespace parkade::simulator
