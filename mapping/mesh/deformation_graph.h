#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/rigid3.h"

namespace parkade {

/// A point that carries what lies around it.
struct DeformationNode {
  Eigen::Vector3d rest = Eigen::Vector3d::Zero();  ///< [m] where it was
  Rigid3 motion;  ///< of its surroundings: translation is where it lies now
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();  ///< at rest, of a keyframe
  Eigen::Vector3d At() const { return motion.translation; }
  /// Where a keyframe is now.
  Rigid3 Pose() const { return {motion.rotation * attitude, motion.translation}; }
  /// Where a point that was beside the node goes with it.
  Eigen::Vector3d Carry(const Eigen::Vector3d& point) const {
    return motion.rotation * (point - rest) + motion.translation;
  }
};

/// The second node wants to lie where the first one carries it, and to be turned alike.
struct DeformationEdge {
  size_t from = 0, to = 0;
  double sigma = 0.01;       ///< [m]
  double turn_sigma = 0.01;  ///< [rad]
};

/// A node whose motion is known.
struct DeformationAnchor {
  size_t node = 0;
  Rigid3 motion;              ///< as DeformationNode::motion
  double sigma = 0.005;       ///< [m]
  double turn_sigma = 0.001;  ///< [rad]
};

/// The pose of one keyframe in another, or in the target frame, as it was measured.
struct DeformationMeasurement {
  std::optional<size_t> from;  ///< nothing: the target frame
  size_t to = 0;
  Rigid3 from_from_to;
  /// Inverse covariance of [translation in `to` as measured | rotation vector]: 1/m^2, 1/rad^2. May
  /// be singular: what it does not know does not count.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Identity();
};

/// Nodes that hold each other as stiffly as edges say, and are pulled by anchors: the embedded
/// deformation of R. Sumner, J. Schmid, M. Pauly, "Embedded Deformation for Shape Manipulation",
/// SIGGRAPH 2007, with rotations in SO(3) and factors of pose graphs, as A. Rosinol et al.,
/// "Kimera: from SLAM to Spatial Perception with 3D Dynamic Scene Graphs", IJRR 2021, do it: with
/// measurements, keyframes and ground are one problem.
struct DeformationGraph {
  std::vector<DeformationNode> nodes;
  std::vector<DeformationEdge> edges;
  std::vector<DeformationAnchor> anchors;
  std::vector<DeformationMeasurement> measurements;
};

using DeformationBlock = Eigen::Matrix<double, 6, 6>;

/// A block of [turn (rad), shift (m)] of a node, both in the target frame: rotation <- Exp(turn)
/// rotation.
struct DeformationFactor {
  Eigen::Matrix<double, 6, 1> residual;  ///< [sigmas]
  DeformationBlock by_first = DeformationBlock::Zero(), by_second = DeformationBlock::Zero();
};

/// r = [(R_a (g_b - g_a) + t_a - t_b) / sigma; Log(R_a R_b^T) / turn_sigma], g at rest; by nodes
/// `from` and `to`.
DeformationFactor EvaluateEdge(const DeformationGraph& graph, const DeformationEdge& edge);

/// r = [(t - t*) / sigma; Log(R R*^T) / turn_sigma], by the anchored node.
DeformationFactor EvaluateAnchor(const DeformationGraph& graph, const DeformationAnchor& anchor);

/// r = S [Rm^T (R_a^T (t_b - t_a) - tm); Log(Rm^T R_a^T R_b)] with S^T S = information and the
/// poses of keyframes; by nodes `from` (zero where there is none) and `to`.
DeformationFactor EvaluateMeasurement(const DeformationGraph& graph,
                                      const DeformationMeasurement& measurement);

/// Half the sum of all squared residuals.
double CostOf(const DeformationGraph& graph);

/// Moves the nodes by Gauss-Newton steps from where they are (a node's motion should start near
/// that of its surroundings) until nothing moves by more than a tenth of a millimeter, at most
/// `max_steps` times; a step that would raise the cost is halved. Nodes that no chain of edges ties
/// to an anchor stay where they are. Returns the number of steps. Sparse Cholesky: seconds for ten
/// thousand nodes.
int SolveDeformation(DeformationGraph& graph, int max_steps = 10);

}  // namespace parkade
