#pragma once

#include <Eigen/Core>
#include <map>
#include <span>
#include <vector>

#include "core/rigid3.h"
#include "core/triangle_mesh.h"
#include "mapping/deformation_graph.h"

namespace parkade {

/// One keyframe before and after trajectories changed; the body stands on the ground.
struct MovedKeyframe {
  Rigid3 from_from_body, to_from_body;
};

struct DeformationOptions {
  double spacing = 2.5;           ///< [m] of nodes on the ground
  double reach = 12;              ///< [m] within which a keyframe saw ground and holds it
  size_t keyframes_per_node = 8;  ///< the nearest of them
  double keyframe_spacing = 2;    ///< [m] between those that are used of one drive
  double stiffness = 0.01;        ///< [m/m] and [rad] by which neighbouring nodes may disagree
  double seen_sigma = 0.02;       ///< [m] of ground beside a keyframe, and 0.01 more per metre away
  double level_gap = 1.0;         ///< [m] of height between nodes of one column: more are two decks
};

/// How the ground of a map moves with the trajectories it was seen from.
class MeshDeformation {
 public:
  /// Where a point on or near the old ground goes. Among the nearest nodes of its own deck, blended by distance
  /// (Sumner et al., eq. 1 to 4).
  Eigen::Vector3d Apply(const Eigen::Vector3d& point_in_from) const;

  /// Whether any of the keyframes saw the ground there. Of what none did, only its neighbours say where it lies.
  bool IsSeen(const Eigen::Vector3d& point_in_from) const;

  const DeformationGraph& graph() const { return graph_; }
  size_t num_ground_nodes() const { return num_ground_nodes_; }

 private:
  friend MeshDeformation DeformGround(const TriangleMesh&, std::span<const MovedKeyframe>, const DeformationOptions&);

  size_t NodeNear(const Eigen::Vector3d& point) const;
  double DistanceTo(size_t node, const Eigen::Vector3d& point) const;

  DeformationGraph graph_;  ///< nodes of the ground, then of keyframes
  size_t num_ground_nodes_ = 0;
  double spacing_ = 1;
  std::map<std::pair<int, int>, std::vector<size_t>> columns_;  ///< nodes of the ground by square
  std::vector<std::vector<size_t>> neighbours_;                 ///< of each, by the mesh
  std::vector<bool> is_seen_;                                   ///< each
};

/// Nodes are spread over the mesh, squares of `spacing`, decks apart; those that one sheet of the mesh joins hold each
/// other, so that decks of a garage pull each other only along their ramps. Keyframes hold the nodes they saw and are
/// held where they are now. Keyframes in order of time, drive after drive. Throws Error{kInvalidInput} without any
/// keyframe.
MeshDeformation DeformGround(const TriangleMesh& mesh, std::span<const MovedKeyframe> keyframes,
                             const DeformationOptions& options = {});

/// The whole mesh moved, its normals turned; the same triangles.
TriangleMesh Deformed(const TriangleMesh& mesh, const MeshDeformation& deformation);

}  // namespace parkade
