#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/ground_patch.h"
#include "core/landmark.h"
#include "core/trajectory.h"
#include "mapping/observation/camera_placement.h"
#include "mapping/observation/ground_options.h"

namespace parkade {

/// What one drive saw of the ground.
struct GroundObservation {
  std::vector<GroundPatch>
      patches;              ///< by time, then camera; patches without a sample are left out
  Rigid3 body_from_ground;  ///< identity with vehicle.yaml; see EstimateBodyFromGround
  int num_images = 0;       ///< decoded
  int num_masks = 0;        ///< of these, with a mask of the log
  std::vector<std::string> warnings;             ///< one sentence each
  std::vector<CameraPlacement> placements = {};  ///< of the cameras, as they were believed to be
};

/// The second pass over a drive: of each camera one image per stretch of travel, its pixels of the
/// ground, in body. `drive` is stored in the patches. No patches and a warning where the ground
/// plane is not known. \param keep  gets the patches, in their order, one at a time; else they are
/// in the result. Bounded memory but for the result: 16 bytes per sample, 5 000 to 20 000 samples
/// per image.
GroundObservation ObserveGround(const DriveLog& log, const Trajectory& odom_from_body,
                                std::span<const Landmark> landmarks, int drive,
                                const GroundOptions& options = {},
                                const std::function<void(GroundPatch&&)>& keep = {});

/// The samples of one image.
/// \param colors            of SampleColors
/// \param body_from_ground  frame of the grid
GroundPatch ObserveImage(const GroundGrid& grid, const CameraFrame& frame, const cv::Mat& colors,
                         GroundLabels&& labels, const Rigid3& body_from_ground,
                         const GroundOptions& options);

}  // namespace parkade
