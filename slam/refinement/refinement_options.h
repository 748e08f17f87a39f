#pragma once

#include "core/option_about.h"

namespace parkade {

struct RefinementOptions {
  bool enabled = true;          ///< false: the pose graph has the last word
  int bearings_per_image = 50;  ///< longest tracks first; more: slower
  int observations_per_track =
      10;                    ///< at most, spread over its images: errors of neighbors are alike
  int min_observations = 4;  ///< of a track that becomes a landmark
  double bearing_inflation =
      2.45;  ///< of the sigma that odometry found, whose estimator weighs bearings alike
  int max_iterations = 10;  ///< of each of the solves: two, and a third where it is taken
  int min_nodes = 100;      ///< fewer: the odometry's window has seen nearly all of them at once
  int max_nodes = 3000;  ///< adjusted at once, some 0.7 GB; longer drives in pieces (SolveInPieces)
  int piece_nodes = 2000;       ///< of a piece
  double held_out_share = 0.2;  ///< of tracks and loops, which judge the result before they join it
  double max_imu_growth =
      1.5;  ///< of the IMU's mean squared error, beyond which the result is not taken
  double max_held_out_growth = 1.0;  ///< the same of the held-out loops' median error
  /// The same of the held-out tracks' mean error; odometry has bent to them.
  double max_track_growth = 1.08;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("enabled", enabled,
          OptionAbout{"The whole drive is adjusted after its loops are closed."});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade
