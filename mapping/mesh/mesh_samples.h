#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/triangle_mesh.h"

namespace parkade {

/// Column and row of a square of ground.
using GroundSquare = std::pair<int, int>;

GroundSquare SquareOf(const Eigen::Vector3d& point, double spacing);

/// Points over the mesh, close enough that each square it touches has some, and which of them are
/// neighbors.
struct MeshSamples {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::pair<size_t, size_t>> links;
};

MeshSamples SampleMesh(const TriangleMesh& mesh, double step);

/// Ground in one square and on one deck.
struct NodeSamples {
  std::vector<size_t> node_of_sample;
  std::vector<Eigen::Vector3d> nodes;
};

/// \param spacing    [m] of the squares
/// \param level_gap  [m] of height between samples of one square: more are two decks
NodeSamples GroupSamples(const MeshSamples& samples, double spacing, double level_gap);

}  // namespace parkade
