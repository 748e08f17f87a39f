#include "mapping/mesh/deformation_graph.h"

#include <Eigen/Sparse>

#include "core/math/decompositions.h"
#include "core/math/sparse_cholesky.h"

namespace parkade {
namespace {

constexpr double kTie = 1e-6;           // information that keeps what nothing holds where it is
constexpr double kSmallestStep = 1e-4;  // [m] and [rad]
constexpr int kMaxHalvings = 6;
constexpr double kRounding = 1e-9;  // of costs

/// The normal equations of one Gauss-Newton step.
class NormalEquations {
 public:
  explicit NormalEquations(size_t num_nodes)
      : gradient_(Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(num_nodes))) {
    for (Eigen::Index i = 0; i < gradient_.size(); ++i) entries_.emplace_back(i, i, kTie);
  }

  void Add(size_t row, const DeformationBlock& by_row, const Vector6d& residual) {
    gradient_.segment<6>(6 * static_cast<Eigen::Index>(row)) += by_row.transpose() * residual;
    AddBlock(row, row, by_row.transpose() * by_row);
  }
  /// Only the lower triangle is kept.
  void AddCross(size_t a, const DeformationBlock& by_a, size_t b, const DeformationBlock& by_b) {
    if (a > b)
      AddBlock(a, b, by_a.transpose() * by_b);
    else
      AddBlock(b, a, by_b.transpose() * by_a);
  }

  Eigen::VectorXd Solve() const {
    Eigen::SparseMatrix<double> matrix(gradient_.size(), gradient_.size());
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    return SolveCholesky(matrix, -gradient_);
  }

 private:
  void AddBlock(size_t row, size_t column, const DeformationBlock& block) {
    for (Eigen::Index i = 0; i < 6; ++i)
      for (Eigen::Index k = 0; k < 6; ++k)
        entries_.emplace_back(6 * static_cast<Eigen::Index>(row) + i,
                              6 * static_cast<Eigen::Index>(column) + k, block(i, k));
  }

  Eigen::VectorXd gradient_;
  std::vector<Eigen::Triplet<double>> entries_;
};

/// Log(first second^T) and its derivatives by turns of both from the left.
struct TurnBetween {
  Eigen::Vector3d turn;
  Eigen::Matrix3d by_first, by_second;
};

TurnBetween Between(const Eigen::Quaterniond& first, const Eigen::Quaterniond& second) {
  TurnBetween between;
  between.turn = LogSo3(first * second.conjugate());
  between.by_first = InverseRightJacobianSo3(-between.turn);  // the inverse left Jacobian
  between.by_second = -InverseRightJacobianSo3(between.turn);
  return between;
}

/// The normal equations at the graph's motions.
Eigen::VectorXd GaussNewtonStep(const DeformationGraph& graph) {
  NormalEquations equations(graph.nodes.size());
  const auto add = [&](const DeformationFactor& factor, std::optional<size_t> first,
                       std::optional<size_t> second) {
    if (first) equations.Add(*first, factor.by_first, factor.residual);
    if (second) equations.Add(*second, factor.by_second, factor.residual);
    if (first && second) equations.AddCross(*first, factor.by_first, *second, factor.by_second);
  };
  for (const DeformationEdge& edge : graph.edges)
    add(EvaluateEdge(graph, edge), edge.from, edge.to);
  for (const DeformationAnchor& anchor : graph.anchors)
    add(EvaluateAnchor(graph, anchor), anchor.node, std::nullopt);
  for (const DeformationMeasurement& measurement : graph.measurements)
    add(EvaluateMeasurement(graph, measurement), measurement.from, measurement.to);
  return equations.Solve();
}

void MoveNodes(const std::vector<DeformationNode>& start, const Eigen::VectorXd& change,
               DeformationGraph& graph) {
  for (size_t i = 0; i < graph.nodes.size(); ++i) {
    const auto first = 6 * static_cast<Eigen::Index>(i);
    const Rigid3& motion = start[i].motion;
    graph.nodes[i].motion = {(ExpSo3(change.segment<3>(first)) * motion.rotation).normalized(),
                             motion.translation + change.segment<3>(first + 3)};
  }
}

}  // namespace

DeformationFactor EvaluateEdge(const DeformationGraph& graph, const DeformationEdge& edge) {
  const DeformationNode &from = graph.nodes[edge.from], &to = graph.nodes[edge.to];
  const Eigen::Vector3d arm = from.motion.rotation * (to.rest - from.rest);
  const TurnBetween between = Between(from.motion.rotation, to.motion.rotation);
  DeformationFactor factor;
  factor.residual << (arm + from.At() - to.At()) / edge.sigma, between.turn / edge.turn_sigma;
  factor.by_first.topLeftCorner<3, 3>() = -Skew(arm) / edge.sigma;
  factor.by_first.topRightCorner<3, 3>() = Eigen::Matrix3d::Identity() / edge.sigma;
  factor.by_first.bottomLeftCorner<3, 3>() = between.by_first / edge.turn_sigma;
  factor.by_second.topRightCorner<3, 3>() = -Eigen::Matrix3d::Identity() / edge.sigma;
  factor.by_second.bottomLeftCorner<3, 3>() = between.by_second / edge.turn_sigma;
  return factor;
}

DeformationFactor EvaluateAnchor(const DeformationGraph& graph, const DeformationAnchor& anchor) {
  const Rigid3& motion = graph.nodes[anchor.node].motion;
  const TurnBetween between = Between(motion.rotation, anchor.motion.rotation);
  DeformationFactor factor;
  factor.residual << (motion.translation - anchor.motion.translation) / anchor.sigma,
      between.turn / anchor.turn_sigma;
  factor.by_first.topRightCorner<3, 3>() = Eigen::Matrix3d::Identity() / anchor.sigma;
  factor.by_first.bottomLeftCorner<3, 3>() = between.by_first / anchor.turn_sigma;
  return factor;
}

DeformationFactor EvaluateMeasurement(const DeformationGraph& graph,
                                      const DeformationMeasurement& measurement) {
  const Rigid3 from = measurement.from ? graph.nodes[*measurement.from].Pose() : Rigid3{};
  const Rigid3 to = graph.nodes[measurement.to].Pose();
  const Eigen::Vector3d apart = to.translation - from.translation;
  const Eigen::Quaterniond measured_from_target =
      (from.rotation * measurement.from_from_to.rotation).conjugate();
  const Eigen::Matrix3d turn = measured_from_target.toRotationMatrix();
  const Eigen::Vector3d rest = LogSo3(measured_from_target * to.rotation);
  const Eigen::Matrix3d by_turn =
      InverseRightJacobianSo3(-rest) * turn;  // the inverse left Jacobian
  DeformationFactor factor;
  factor.residual << turn * apart - measurement.from_from_to.rotation.conjugate() *
                                        measurement.from_from_to.translation,
      rest;
  if (measurement.from) {
    factor.by_first.topLeftCorner<3, 3>() = turn * Skew(apart);
    factor.by_first.topRightCorner<3, 3>() = -turn;
    factor.by_first.bottomLeftCorner<3, 3>() = -by_turn;
  }
  factor.by_second.topRightCorner<3, 3>() = turn;
  factor.by_second.bottomLeftCorner<3, 3>() = by_turn;
  const DeformationBlock root = SquareRootOf(measurement.information);
  return {root * factor.residual, root * factor.by_first, root * factor.by_second};
}

double CostOf(const DeformationGraph& graph) {
  double sum = 0;
  for (const DeformationEdge& edge : graph.edges)
    sum += EvaluateEdge(graph, edge).residual.squaredNorm();
  for (const DeformationAnchor& anchor : graph.anchors)
    sum += EvaluateAnchor(graph, anchor).residual.squaredNorm();
  for (const DeformationMeasurement& measurement : graph.measurements)
    sum += EvaluateMeasurement(graph, measurement).residual.squaredNorm();
  return 0.5 * sum;
}

int SolveDeformation(DeformationGraph& graph, int max_steps) {
  double cost = CostOf(graph);
  for (int step = 1; step <= max_steps; ++step) {
    Eigen::VectorXd change = GaussNewtonStep(graph);
    const std::vector<DeformationNode> start = graph.nodes;
    MoveNodes(start, change, graph);
    double moved_cost = CostOf(graph);
    const double allowed = (1 + kRounding) * cost + kRounding;
    for (int i = 0; i < kMaxHalvings && moved_cost > allowed; ++i) {
      MoveNodes(start, change *= 0.5, graph);
      moved_cost = CostOf(graph);
    }
    if (moved_cost > allowed) {
      graph.nodes = start;
      return step;
    }
    cost = moved_cost;
    if (change.size() == 0 || change.cwiseAbs().maxCoeff() < kSmallestStep) return step;
  }
  return max_steps;
}

}  // namespace parkade
