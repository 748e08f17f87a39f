#pragma once

#include <array>

#include "core/rig.h"
#include "tests/simulator/fast_pose.h"
#include "tests/simulator/sample_table.h"
#include "tests/simulator/shot.h"

namespace parkade::simulator {

/// The car's place at the moment of each of the four samples of a row's pixels.
struct RowPoses {
  std::array<FastPose, kSamplesPerPixel> world_from_camera, world_from_body, body_from_world;
  std::array<float, kSamplesPerPixel> time{};  ///< of the samples, 0..1 over the picture
  float speed = 0;                             ///< [m/s]
  bool is_covered = false;                     ///< the car is under a roof
};

/// All rows and their exposures are within this of the middle of the picture [s].
double PictureHalfTime(const RigCamera& camera, const Shot& shot);

/// Rows are exposed one after the other by the camera's line delay. `is_covered` is left to the caller.
RowPoses PosesOfRow(const RigCamera& camera, const Shot& shot, int row);

}  // namespace parkade::simulator
