#include "slam/pose_graph/pose_graph_start.h"

#include <Eigen/SparseCholesky>
#include <queue>
#include <tuple>

#include "core/math/decompositions.h"

namespace parkade {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// Unknowns of vertices that are not anchored: index among them, or -1.
std::vector<int> NumberUnknowns(const std::vector<bool>& anchors, int& num_unknown) {
  std::vector<int> index(anchors.size(), -1);
  num_unknown = 0;
  for (size_t i = 0; i < anchors.size(); ++i)
    if (!anchors[i]) index[i] = num_unknown++;
  return index;
}

/// Weights of one part of the edges' errors.
std::vector<double> WeightsOf(const PoseGraph& graph, const std::vector<double>& factors,
                              double EdgeConcentrations::*part) {
  std::vector<double> weights;
  for (size_t i = 0; i < graph.edges.size(); ++i)
    weights.push_back((factors.empty() ? 1 : factors[i]) *
                      (ConcentrationsOf(graph.edges[i], graph.is_planar).*part));
  return weights;
}

/// Solves the normal equations; empty where they do not fix the unknowns.
Eigen::MatrixXd SolveSparse(int size, const Triplets& lower_triangle,
                            const Eigen::MatrixXd& right_hand_side) {
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(lower_triangle.begin(), lower_triangle.end());
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) return {};
  Eigen::MatrixXd solution = solver.solve(right_hand_side);
  return solution.allFinite() ? solution : Eigen::MatrixXd();
}

/// Minimizes sum w |X_to - R^T X_from|^2 over X = transposed rotations, each 3 x 3. False where
/// that fails.
bool RelaxRotations(const PoseGraph& graph, const std::vector<bool>& anchors,
                    const std::vector<double>& weights, std::vector<Rigid3>& poses) {
  int num_unknown = 0;
  const std::vector<int> unknown = NumberUnknowns(anchors, num_unknown);
  Triplets triplets;
  triplets.reserve(graph.edges.size() * 15);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(3 * num_unknown, 3);
  for (size_t e = 0; e < graph.edges.size(); ++e) {
    if (weights[e] == 0) continue;  // would only fill the factorization
    const PoseGraphEdge& edge = graph.edges[e];
    const int from = unknown[edge.from], to = unknown[edge.to];
    const Eigen::Matrix3d measured = weights[e] * edge.from_from_to.rotation.toRotationMatrix();
    for (const int vertex : {from, to})
      for (int k = 0; vertex >= 0 && k < 3; ++k)
        triplets.emplace_back(3 * vertex + k, 3 * vertex + k, weights[e]);
    if (from >= 0 && to >= 0) {
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) {
          const int i = 3 * from + row, j = 3 * to + column;
          triplets.emplace_back(std::max(i, j), std::min(i, j), -measured(row, column));
        }
    } else if (from >= 0) {
      const Eigen::Matrix3d known = poses[edge.to].rotation.toRotationMatrix().transpose();
      right.middleRows<3>(3 * from) += measured * known;
    } else if (to >= 0) {
      const Eigen::Matrix3d known = poses[edge.from].rotation.toRotationMatrix().transpose();
      right.middleRows<3>(3 * to) += measured.transpose() * known;
    }
  }
  const Eigen::MatrixXd solution = SolveSparse(3 * num_unknown, triplets, right);
  if (solution.rows() != right.rows()) return false;
  for (size_t i = 0; i < poses.size(); ++i)
    if (unknown[i] >= 0)
      poses[i].rotation = NearestRotation(solution.middleRows<3>(3 * unknown[i]).transpose());
  return true;
}

/// Minimizes sum w |t_to - t_from - R_from t|^2 with the rotations held. False where that fails.
bool SolveTranslations(const PoseGraph& graph, const std::vector<bool>& anchors,
                       const std::vector<double>& weights, std::vector<Rigid3>& poses) {
  int num_unknown = 0;
  const std::vector<int> unknown = NumberUnknowns(anchors, num_unknown);
  Triplets triplets;
  triplets.reserve(graph.edges.size() * 3);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(num_unknown, 3);
  for (size_t e = 0; e < graph.edges.size(); ++e) {
    if (weights[e] == 0) continue;  // would only fill the factorization
    const PoseGraphEdge& edge = graph.edges[e];
    const int from = unknown[edge.from], to = unknown[edge.to];
    const Eigen::Vector3d step = poses[edge.from].rotation * edge.from_from_to.translation;
    if (from >= 0) {
      triplets.emplace_back(from, from, weights[e]);
      right.row(from) -= weights[e] * step.transpose();
      if (to < 0) right.row(from) += weights[e] * poses[edge.to].translation.transpose();
    }
    if (to >= 0) {
      triplets.emplace_back(to, to, weights[e]);
      right.row(to) += weights[e] * step.transpose();
      if (from < 0) right.row(to) += weights[e] * poses[edge.from].translation.transpose();
    }
    if (from >= 0 && to >= 0)
      triplets.emplace_back(std::max(from, to), std::min(from, to), -weights[e]);
  }
  const Eigen::MatrixXd solution = SolveSparse(num_unknown, triplets, right);
  if (solution.rows() != right.rows()) return false;
  for (size_t i = 0; i < poses.size(); ++i)
    if (unknown[i] >= 0) poses[i].translation = solution.row(unknown[i]).transpose();
  return true;
}

std::vector<Rigid3> PosesOf(const PoseGraph& graph) {
  std::vector<Rigid3> poses;
  for (const PoseGraphVertex& vertex : graph.vertices) poses.push_back(vertex.world_from_vertex);
  return poses;
}

}  // namespace

std::vector<Rigid3> ChainEdges(const PoseGraph& graph) {
  std::vector<std::vector<size_t>> edges_of(graph.vertices.size());
  for (size_t e = 0; e < graph.edges.size(); ++e)
    for (const size_t vertex : {graph.edges[e].from, graph.edges[e].to})
      edges_of[vertex].push_back(e);

  std::vector<Rigid3> poses = PosesOf(graph);
  std::vector<bool> is_placed = FindAnchors(graph);
  // Edges that lead on from a placed vertex, the best first.
  using Candidate = std::tuple<bool, std::int64_t, size_t>;  // is not trusted, gap, edge
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates;
  const auto reach = [&](size_t vertex) {
    for (const size_t e : edges_of[vertex])
      candidates.emplace(!graph.edges[e].is_trusted, IdGap(graph, graph.edges[e]), e);
  };
  for (size_t i = 0; i < poses.size(); ++i)
    if (is_placed[i]) reach(i);
  while (!candidates.empty()) {
    const PoseGraphEdge& edge = graph.edges[std::get<size_t>(candidates.top())];
    candidates.pop();
    if (is_placed[edge.from] && is_placed[edge.to]) continue;
    const bool is_forward = is_placed[edge.from];
    const size_t next = is_forward ? edge.to : edge.from;
    poses[next] = is_forward ? poses[edge.from] * edge.from_from_to
                             : poses[edge.to] * edge.from_from_to.Inverse();
    is_placed[next] = true;
    reach(next);
  }
  return poses;
}

std::vector<Rigid3> RelaxChordally(const PoseGraph& graph, const std::vector<double>& weights) {
  const std::vector<bool> anchors = FindAnchors(graph);
  std::vector<Rigid3> poses = PosesOf(graph);
  if (!RelaxRotations(graph, anchors, WeightsOf(graph, weights, &EdgeConcentrations::kappa), poses))
    return {};
  if (!SolveTranslations(graph, anchors, WeightsOf(graph, weights, &EdgeConcentrations::tau),
                         poses))
    return {};
  return poses;
}

}  // namespace parkade
