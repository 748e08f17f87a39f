#include "slam/pose_graph/pose_graph.h"

#include <numeric>

#include "core/error.h"
#include "core/math/decompositions.h"

namespace parkade {
namespace {

/// Harmonic mean of the eigenvalues of a positive semidefinite matrix; 0 where it is singular.
double HarmonicMeanOfEigenvalues(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  const Eigen::VectorXd eigenvalues = SymmetricEigenvalues(matrix);
  // Below this share of the largest, an eigenvalue is rounding.
  constexpr double kSingular = 1e-12;
  if (eigenvalues.minCoeff() <= kSingular * eigenvalues.maxCoeff()) return 0;
  return static_cast<double>(eigenvalues.size()) / eigenvalues.cwiseInverse().sum();
}

}  // namespace

std::int64_t IdGap(const PoseGraph& graph, const PoseGraphEdge& edge) {
  const auto [first, last] =
      std::minmax({graph.vertices[edge.from].id, graph.vertices[edge.to].id});
  return last - first;
}

Vector6d RelativePoseError(const PoseGraphEdge& edge, const Rigid3& world_from_from,
                           const Rigid3& world_from_to) {
  const Rigid3 error = edge.from_from_to.Inverse() * (world_from_from.Inverse() * world_from_to);
  Vector6d result;
  result << error.translation, (error.rotation.w() < 0 ? -2.0 : 2.0) * error.rotation.vec();
  return result;
}

EdgeConcentrations ConcentrationsOf(const PoseGraphEdge& edge, bool is_planar) {
  if (is_planar)
    return {edge.information(5, 5),
            HarmonicMeanOfEigenvalues(edge.information.topLeftCorner<2, 2>())};
  return {0.5 * HarmonicMeanOfEigenvalues(edge.information.bottomRightCorner<3, 3>()),
          HarmonicMeanOfEigenvalues(edge.information.topLeftCorner<3, 3>())};
}

Matrix6d SquareRootWeight(const PoseGraph& graph, const PoseGraphEdge& edge,
                          PoseGraphObjective objective) {
  if (objective == PoseGraphObjective::kChordal) {
    const EdgeConcentrations concentrations = ConcentrationsOf(edge, graph.is_planar);
    Vector6d diagonal;
    diagonal << Eigen::Vector3d::Constant(std::sqrt(concentrations.tau)),
        Eigen::Vector3d::Constant(std::sqrt(2 * concentrations.kappa));
    return diagonal.asDiagonal();
  }
  const Eigen::VectorXd eigenvalues = SymmetricEigenvalues(edge.information);
  Require(eigenvalues.minCoeff() >= -1e-6 * eigenvalues.maxCoeff(), ErrorCode::kInvalidInput,
          "the information matrix of the edge from " +
              std::to_string(graph.vertices[edge.from].id) + " to " +
              std::to_string(graph.vertices[edge.to].id) +
              " is not positive semidefinite; the chordal objective does without its mixed terms");
  return SquareRootOf(edge.information);
}

double SquaredError(const PoseGraph& graph, const PoseGraphEdge& edge,
                    PoseGraphObjective objective) {
  const Vector6d error = RelativePoseError(edge, graph.vertices[edge.from].world_from_vertex,
                                           graph.vertices[edge.to].world_from_vertex);
  if (objective == PoseGraphObjective::kInformation) return error.dot(edge.information * error);
  const EdgeConcentrations concentrations = ConcentrationsOf(edge, graph.is_planar);
  return concentrations.tau * error.head<3>().squaredNorm() +
         2 * concentrations.kappa * error.tail<3>().squaredNorm();
}

double ObjectiveOf(const PoseGraph& graph, PoseGraphObjective objective) {
  double sum = 0;
  for (const PoseGraphEdge& edge : graph.edges) sum += SquaredError(graph, edge, objective);
  return sum;
}

std::vector<bool> FindAnchors(const PoseGraph& graph) {
  // Union-find: every vertex points to an earlier one of its part, or to itself.
  std::vector<size_t> parent(graph.vertices.size());
  std::iota(parent.begin(), parent.end(), size_t{0});
  const auto root_of = [&parent](size_t vertex) {
    while (parent[vertex] != vertex) vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
  };
  for (const PoseGraphEdge& edge : graph.edges) {
    const size_t a = root_of(edge.from), b = root_of(edge.to);
    parent[std::max(a, b)] = std::min(a, b);
  }
  std::vector<bool> anchors(graph.vertices.size()), is_held(graph.vertices.size());
  for (size_t i = 0; i < anchors.size(); ++i) {
    if (!graph.vertices[i].is_fixed) continue;
    anchors[i] = true;
    is_held[root_of(i)] = true;
  }
  for (size_t i = 0; i < anchors.size(); ++i)
    if (root_of(i) == i && !is_held[i]) anchors[i] = true;
  return anchors;
}

}  // namespace parkade
