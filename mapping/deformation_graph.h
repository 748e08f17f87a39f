#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/rigid3.h"

namespace parkade {

/// A point that carries what lies around it.
struct DeformationNode {
  Eigen::Vector3d rest = Eigen::Vector3d::Zero();  ///< [m] where it was
  Rigid3 motion;                                   ///< of its surroundings: translation is where it lies now
  Eigen::Vector3d At() const { return motion.translation; }
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

/// Nodes that hold each other as stiffly as edges say, and are pulled by anchors: the embedded deformation of R.
/// Sumner, J. Schmid, M. Pauly, "Embedded Deformation for Shape Manipulation", SIGGRAPH 2007, with rotations in SO(3)
/// and factors of pose graphs, as A. Rosinol et al., "Kimera: from SLAM to Spatial Perception with 3D Dynamic Scene
/// Graphs", IJRR 2021, do it.
struct DeformationGraph {
  std::vector<DeformationNode> nodes;
  std::vector<DeformationEdge> edges;
  std::vector<DeformationAnchor> anchors;
};

using DeformationBlock = Eigen::Matrix<double, 6, 6>;

/// Of [turn (rad), shift (m)] of a node, both in the target frame: rotation <- Exp(turn) rotation.
struct DeformationFactor {
  Eigen::Matrix<double, 6, 1> residual;  ///< [sigmas]
  DeformationBlock by_first = DeformationBlock::Zero(), by_second = DeformationBlock::Zero();
};

/// r = [(R_a (g_b - g_a) + t_a - t_b) / sigma; Log(R_a R_b^T) / turn_sigma], g at rest; by nodes `from` and `to`.
DeformationFactor EvaluateEdge(const DeformationGraph& graph, const DeformationEdge& edge);

/// r = [(t - t*) / sigma; Log(R R*^T) / turn_sigma], by the anchored node.
DeformationFactor EvaluateAnchor(const DeformationGraph& graph, const DeformationAnchor& anchor);

/// Moves the nodes by Gauss-Newton steps from where they are (a node's motion should start near that of its
/// surroundings) until nothing moves by more than a tenth of a millimetre, at most `max_steps` times. Nodes that no
/// chain of edges ties to an anchor stay where they are. Returns the number of steps. Sparse Cholesky: seconds for ten
/// thousand nodes.
int SolveDeformation(DeformationGraph& graph, int max_steps = 10);

}  // namespace parkade
