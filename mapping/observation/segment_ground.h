#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "mapping/ground/ground_grid.h"
#include "mapping/ground/ground_label.h"
#include "mapping/networks/freespace_network.h"

namespace parkade {

struct SegmentGroundOptions {
  double obstacle_depth =
      1.2;  ///< [m] of not-ground that a guess needs; what follows on its ray is hidden
  double hidden_confidence =
      0.25;  ///< of what a mask or a network has behind the foot: a hint that it is not free
  double beyond_depth =
      2.0;  ///< [m] of not-ground of which the colors are kept: how high it is can be told
  double foot_depth =
      0.2;  ///< [m] the same for a mask or a network, to which one pixel's ground is added
  double sure_log_odds =
      4.0;  ///< of a network from which it is taken to be sure; below, it counts in proportion
  double doubt_per_meter =
      0.25;  ///< taken off a network's log-odds the farther the ground is: far outlines blur ...
  double doubt_from = 2.0;  ///< [m] ... where nothing is taken off; nearer, it is added
  void Validate() const;    ///< throws Error{kUsage}
};

/// The labels of a grid's cells and how sure they are.
struct GroundLabels {
  std::vector<GroundLabel> labels;
  std::vector<float> confidence = {};       ///< 0 to 1; empty: all are sure
  std::vector<SurfaceClass> surfaces = {};  ///< empty: not told
  bool is_trusted = false;                  ///< ground seen behind obstacles is believed
};

/// The labels that a mask (CV_8UC1 of the image's size, >= 128 = drivable) gives.
std::vector<GroundLabel> LabelsFromMask(const GroundGrid& grid, const cv::Mat& mask);

/// The labels that a network gives: ground where its log-odds, less the doubt at that range, are
/// above 0, doubtful where the doubt alone makes the difference; sure from `sure_log_odds` on.
/// \param pixels  of what the belief is of, one per cell of the grid; beyond it nothing is known
GroundLabels LabelsFromBelief(const GroundGrid& grid, std::span<const Eigen::Vector2f> pixels,
                              const FreespaceBelief& belief, const SegmentGroundOptions& options);

/// Pixels of an obstacle meet the plane behind its foot: some kNotGround behind the last ground
/// (see obstacle_depth, foot_depth) says where it stands, what follows becomes kHidden, after
/// obstacle_depth kBeyond, after beyond_depth kUnknown. So does kNotGround before a ray's first
/// ground (most often the own car), and, unless the labels are trusted, any ground behind an
/// obstacle. kDoubtful stays, and so does land that is seen to lie level: it hides nothing.
void HideBehindObstacles(const GroundGrid& grid, const SegmentGroundOptions& options,
                         GroundLabels& found);

}  // namespace parkade
