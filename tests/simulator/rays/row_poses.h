#pragma once

#include <array>

#include "core/rig.h"
#include "tests/simulator/common/fast_pose.h"
#include "tests/simulator/common/sample_pattern.h"
#include "tests/simulator/rays/shot.h"

namespace parkade::simulator {

/// The car's place at one moment.
struct MomentPose {
  FastPose world_from_camera, world_from_body, body_from_world;
  float time = 0;  ///< 0..1 over the image
};

/// The car's places while a row is exposed.
struct RowPoses {
  std::array<MomentPose, kNumMoments> moments;
  float speed = 0;          ///< [m/s]
  bool is_covered = false;  ///< the car is under a roof
};

/// All rows and their exposures are within this of the middle of the image [s].
double ImageHalfTime(const RigCamera& camera, const Shot& shot);

/// Rows are exposed one after the other by the camera's line delay. Between the first and the last
/// moment the car is taken to move evenly: less than 0.1 mm off. `is_covered` is left to the
/// caller.
RowPoses PosesOfRow(const RigCamera& camera, const Shot& shot, int row);

}  // namespace parkade::simulator
