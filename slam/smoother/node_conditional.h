#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slam/factors/linear_prior.h"
#include "slam/smoother/record_store.h"

namespace parkade {

struct RecordedNode;

/// What states were, given the states that stayed when they left the window: the
/// rows that marginalization in square-root form sets aside,
///   own (x [-] at) + to_rest (rest [-] at) + offset = 0.
/// Single precision: corrections are small.
struct StateConditional {
  std::vector<PriorBlock>
      states;           ///< with the values they had then; pose and motion of a node, or one camera
  Eigen::MatrixXf own;  ///< upper triangular
  Eigen::MatrixXf to_rest;
  Eigen::VectorXf offset;
  Eigen::MatrixXf offset_covariance;   ///< ScoreElimination::dropped
  Eigen::MatrixXf score_with_offset;   ///< ScoreElimination::cross
  Eigen::MatrixXf offset_sensitivity;  ///< ScoreElimination::dropped_sensitivity
  std::vector<PriorBlock> rest;
};

/// What was learned of a node when it left the window, and of what left with it.
struct NodeConditionals {
  std::optional<StateConditional> own;  ///< empty for the last node of all
  /// The same for cameras whose calibration was reopened before this node left and after the node
  /// before it did.
  std::vector<StateConditional> reopened;
};

/// The conditionals of all nodes of a drive, on disk: 3 KB each.
class ConditionalStore {
 public:
  void Add(NodeConditionals conditionals);
  NodeConditionals operator[](size_t node) const;
  size_t size() const { return store_.size(); }

 private:
  RecordStore<NodeConditionals> store_;
};

/// States with their values, and the covariance of all of them.
struct JointEstimate {
  std::vector<PriorBlock> states;
  Eigen::MatrixXd covariance;        ///< may be empty: unknown
  Eigen::MatrixXd model_covariance;  ///< inverse information
  Eigen::MatrixXd
      sensitivity;  ///< of the errors, by what is considered: its square is part of `covariance`
};

/// Corrects all nodes of a drive by what was learned after they left the window,
/// from the last to the first: the linear smoother of the whole drive, without
/// solving it. A car learns on its first turn how it was tilted before.
///
/// H. E. Rauch, F. Tung, C. T. Striebel, "Maximum likelihood estimates of linear
/// dynamic systems", AIAA Journal 1965, here as back-substitution of the QR.
/// `nodes` are all that left the window, in order, with `conditionals` of each; the last is taken
/// as it is. `last` holds its pose and motion, and what all nodes share: wheel scale, cameras. Sets
/// the covariances, too. Linear in the drive's length; reads one node's conditionals at a time.
void SmoothBackwards(std::vector<RecordedNode>& nodes, const ConditionalStore& conditionals,
                     const JointEstimate& last);

}  // namespace parkade
