#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/rigid3.h"
#include "core/triangle_mesh.h"
#include "mapping/mesh/deformation_graph.h"

namespace parkade {

/// One keyframe before and after trajectories changed; the body stands on the ground.
struct MovedKeyframe {
  Rigid3 from_from_body, to_from_body;
};

/// One keyframe whose place is looked for together with that of the ground.
struct FreeKeyframe {
  std::optional<Rigid3> from_from_body;  ///< nothing: it is new, and no ground hangs on it
  Rigid3 to_from_body;                   ///< where the search begins
  bool is_held = false;                  ///< it ends there, too
};

struct DeformationOptions {
  double spacing = 2.5;        ///< [m] of nodes on the ground
  double ground_share = 1e-4;  ///< of the ground's information that counts where keyframes are
                               ///< free, see DeformJointly
};

/// How the ground of a map moves with the trajectories it was seen from.
class MeshDeformation {
 public:
  /// Where a point on or near the old ground goes. Among the nearest nodes of its own deck, blended
  /// by distance (Sumner et al., eq. 1 to 4).
  Eigen::Vector3d Apply(const Eigen::Vector3d& point_in_from) const;

  /// Whether any of the keyframes saw the ground there. Of what none did, only its neighbors say
  /// where it lies.
  bool IsSeen(const Eigen::Vector3d& point_in_from) const;

  const DeformationGraph& graph() const { return graph_; }

 private:
  friend class DeformationBuilder;

  size_t NodeNear(const Eigen::Vector3d& point) const;
  double DistanceTo(size_t node, const Eigen::Vector3d& point) const;

  DeformationGraph graph_;  ///< nodes of the ground, then of keyframes
  size_t num_ground_nodes_ = 0;
  double spacing_ = 1;
  std::map<std::pair<int, int>, std::vector<size_t>> columns_;  ///< nodes of the ground by square
  std::vector<std::vector<size_t>> neighbors_;                  ///< of each, by the mesh
  std::vector<bool> is_seen_;                                   ///< each
};

/// Nodes are spread over the mesh, squares of `spacing`, decks apart; those that triangles of the
/// mesh join hold each other, so that decks of a garage pull each other only along their ramps.
/// Keyframes hold the nodes they saw and are held where they are now. Keyframes in order of time,
/// drive after drive. Throws Error{kInvalidInput} without any keyframe.
MeshDeformation DeformGround(const TriangleMesh& mesh, std::span<const MovedKeyframe> keyframes,
                             const DeformationOptions& options = {});

struct JointDeformation {
  MeshDeformation ground;
  std::vector<Rigid3> to_from_body;  ///< of all keyframes, as they were given
};

/// Ground and keyframes solved as one problem, as A. Rosinol et al., IJRR 2021, section 3.3
/// (Kimera-PGMO) do it: what was measured between keyframes (odometry, loops, links), ground that
/// hangs on those that saw it, and ground that holds together. `measurements` name keyframes by
/// index. Loops that may be wrong do not belong among them: whoever solved the pose graph knows
/// which to leave out. Without a held keyframe or a measurement in the target frame all of it may
/// float.
///
/// The old ground is where the old keyframes put it: stiff, it would pull them back to that, and
/// two passes whose ground was fused into one would never come apart. Of its information only
/// `ground_share` counts against measurements. Throws Error{kInvalidInput} without any keyframe
/// that has been in the old map.
JointDeformation DeformJointly(const TriangleMesh& mesh, std::span<const FreeKeyframe> keyframes,
                               std::span<const DeformationMeasurement> measurements,
                               const DeformationOptions& options = {});

}  // namespace parkade
