#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/rig.h"
#include "core/trajectory.h"
#include "mapping/ground/ground_grid.h"
#include "mapping/ground/wheelbase_footprint.h"
#include "mapping/networks/freespace_network.h"
#include "mapping/networks/level_view.h"
#include "mapping/observation/ground_options.h"
#include "mapping/observation/masked_image_stream.h"

namespace parkade {

/// What a network is shown of one camera's images, and where in it the cells of the camera's grid
/// lie.
struct NetworkView {
  std::optional<LevelView> level;  ///< empty: the images as they are
  std::vector<Eigen::Vector2f> pixels;
};

/// Labels what images show, by the surest means there is: the log's own mask, the network, or
/// colors.
class ImageLabeler {
 public:
  /// Borrows the trajectory, the grids (one per camera of the rig) and the options.
  ImageLabeler(const Trajectory& odom_from_body, const Rigid3& body_from_ground, const Rig& rig,
               std::span<const GroundGrid> grids, const GroundOptions& options);

  /// Thread-safe. `colors` are those of SampleColors.
  GroundLabels Label(const ImageWithMask& image, const cv::Mat& colors) const;

 private:
  FreespaceBelief BeliefOf(const CameraFrame& frame) const;

  const Trajectory* odom_from_body_;
  Rigid3 body_from_ground_;
  WheelbaseFootprint contact_;
  std::span<const GroundGrid> grids_;
  const GroundOptions* options_;
  std::vector<NetworkView> views_;  ///< one per camera; empty: no network is asked
  std::unique_ptr<FreespaceNetwork> level_network_;
  std::optional<FreespaceNetwork> image_network_;
};

}  // namespace parkade
