#pragma once

#include "slam/pose_graph/pose_graph.h"

namespace parkade {

/// Poses along a tree from the anchors (FindAnchors): trusted edges first, then those between the
/// nearest ids. In the order of the graph's vertices.
std::vector<Rigid3> ChainEdges(const PoseGraph& graph);

/// Poses that come close to the least chordal error from nothing but the measurements: first
/// rotations as free 3x3 matrices, a linear problem, and the nearest rotation of each; then
/// translations, linear again. D. Martinec and T. Pajdla, "Robust Rotation and Translation
/// Estimation in Multiview Reconstruction", CVPR 2007; L. Carlone et al., "Initialization
/// Techniques for 3D SLAM", ICRA 2015. Two sparse Cholesky factorizations.
///
/// \param weights  one factor per edge on its weight, >= 0; empty: all 1. Empty result where the
/// weighted edges do
///                 not hold all poses.
std::vector<Rigid3> RelaxChordally(const PoseGraph& graph, const std::vector<double>& weights = {});

}  // namespace parkade
