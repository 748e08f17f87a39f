#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/rigid3.h"

namespace parkade {

struct PoseGraphVertex {
  std::int64_t id = 0;
  Rigid3 world_from_vertex;
  bool is_fixed = false;
};

/// A measured relative pose between two vertices.
struct PoseGraphEdge {
  size_t from = 0, to = 0;  ///< indices of vertices
  Rigid3 from_from_to;      ///< as measured
  /// Inverse covariance of RelativePoseError, [translation in `to` | rotation vector]: 1/m^2,
  /// 1/rad^2. May be singular: what it does not know does not count.
  Matrix6d information = Matrix6d::Identity();
  bool is_trusted = false;  ///< odometry: GNC never doubts it
};

/// Poses and what was measured between them. Where `is_planar`, all poses and
/// measurements have z = 0, no roll and no pitch, and stay so.
struct PoseGraph {
  std::vector<PoseGraphVertex> vertices;
  std::vector<PoseGraphEdge> edges;
  bool is_planar = false;
};

/// How far apart an edge's ends are in time, in ids.
std::int64_t IdGap(const PoseGraph& graph, const PoseGraphEdge& edge);

/// Which error of an edge is squared and added up.
enum class PoseGraphObjective {
  /// kappa |R_to - R_from R|^2_F + tau |t_to - t_from - R_from t|^2, one kappa and tau per edge:
  /// what SE-Sync
  /// solves to the certified optimum. D. Rosen et al., "SE-Sync", IJRR 2019, problem 1.
  kChordal,
  /// e^T information e with e = RelativePoseError: directions count as much as each edge knows
  /// them.
  kInformation,
};

/// [translation in `to` as measured | twice the vector part of the quaternion]
/// of measured^-1 * actual. The rotation part is the rotation vector up to third
/// order, and its square is half of the squared chordal distance.
Vector6d RelativePoseError(const PoseGraphEdge& edge, const Rigid3& world_from_from,
                           const Rigid3& world_from_to);

/// Concentrations of an edge as SE-Sync makes them from its information: harmonic means of the
/// eigenvalues of the translation block (tau) and, halved, of the rotation block (kappa). In the
/// plane kappa is the information of the angle itself, not its half. Zero where the block is
/// singular.
struct EdgeConcentrations {
  double kappa = 0;  ///< [1/rad^2]
  double tau = 0;    ///< [1/m^2]
};
EdgeConcentrations ConcentrationsOf(const PoseGraphEdge& edge, bool is_planar);

/// S with S^T S = what RelativePoseError of an edge is weighted with under `objective`. Throws
/// Error{kInvalidInput} for kInformation where that matrix is not positive semidefinite.
Matrix6d SquareRootWeight(const PoseGraph& graph, const PoseGraphEdge& edge,
                          PoseGraphObjective objective);

/// The squared, weighted error of one edge at the graph's poses.
double SquaredError(const PoseGraph& graph, const PoseGraphEdge& edge,
                    PoseGraphObjective objective);

/// Sum over all edges: for kChordal SE-Sync's objective, without a factor of one half.
double ObjectiveOf(const PoseGraph& graph, PoseGraphObjective objective);

/// The vertices that hold the graph in place: those fixed, and the first vertex of every connected
/// part without one. One flag per vertex.
std::vector<bool> FindAnchors(const PoseGraph& graph);

}  // namespace parkade
