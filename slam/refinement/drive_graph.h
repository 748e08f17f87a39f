#pragma once

#include "slam/factors/factor_graph.h"
#include "slam/refinement/adjusted_drive.h"

namespace parkade {

/// Nodes [begin, end) that move in a solve.
struct AdjustedStretch {
  size_t begin = 0, end = 0;
  bool has_open_end =
      false;  ///< what hangs on nodes from `end` on is left out; else they hold their places
  bool frees_calibration = false;
};

/// A stretch of a drive as a factor graph, over the drive's own parameters.
class DriveGraph {
 public:
  /// \param bearing_weight  of the loss of bearings beside the other factors'
  DriveGraph(AdjustedDrive& drive, const AdjustedStretch& stretch, double bearing_weight);

  FactorGraph& graph() { return graph_; }

 private:
  void AddIntervals();
  void AddCalibration();
  void AddLoops();
  void AddFixes();
  void AddLandmarks();
  bool IsMoved(size_t node) const { return node >= stretch_.begin && node < stretch_.end; }
  bool IsLeftOut(size_t node) const { return stretch_.has_open_end && node >= stretch_.end; }
  /// Adds the block where it is new.
  double* PoseOf(size_t node);
  const NodeBlocks& NodeOf(size_t node);
  double* BlockOf(const StateName& name) const;

  AdjustedDrive& drive_;
  AdjustedStretch stretch_;
  FactorGraph graph_;
};

}  // namespace parkade
