#include "mapping/deformation_graph.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "core/error.h"

namespace parkade {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kTie = 1e-6;           // information that keeps what nothing holds where it is
constexpr double kSmallestStep = 1e-4;  // [m] and [rad]

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
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver(matrix);
    Require(solver.info() == Eigen::Success, ErrorCode::kInternal, "the deformation graph cannot be solved");
    return solver.solve(-gradient_);
  }

 private:
  void AddBlock(size_t row, size_t column, const DeformationBlock& block) {
    for (Eigen::Index i = 0; i < 6; ++i)
      for (Eigen::Index k = 0; k < 6; ++k)
        entries_.emplace_back(6 * static_cast<Eigen::Index>(row) + i, 6 * static_cast<Eigen::Index>(column) + k,
                              block(i, k));
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
  factor.residual << (motion.translation - anchor.motion.translation) / anchor.sigma, between.turn / anchor.turn_sigma;
  factor.by_first.topRightCorner<3, 3>() = Eigen::Matrix3d::Identity() / anchor.sigma;
  factor.by_first.bottomLeftCorner<3, 3>() = between.by_first / anchor.turn_sigma;
  return factor;
}

int SolveDeformation(DeformationGraph& graph, int max_steps) {
  for (int step = 1; step <= max_steps; ++step) {
    NormalEquations equations(graph.nodes.size());
    for (const DeformationEdge& edge : graph.edges) {
      const DeformationFactor factor = EvaluateEdge(graph, edge);
      equations.Add(edge.from, factor.by_first, factor.residual);
      equations.Add(edge.to, factor.by_second, factor.residual);
      equations.AddCross(edge.from, factor.by_first, edge.to, factor.by_second);
    }
    for (const DeformationAnchor& anchor : graph.anchors) {
      const DeformationFactor factor = EvaluateAnchor(graph, anchor);
      equations.Add(anchor.node, factor.by_first, factor.residual);
    }
    const Eigen::VectorXd change = equations.Solve();
    for (size_t i = 0; i < graph.nodes.size(); ++i) {
      const auto first = 6 * static_cast<Eigen::Index>(i);
      Rigid3& motion = graph.nodes[i].motion;
      motion.rotation = (ExpSo3(change.segment<3>(first)) * motion.rotation).normalized();
      motion.translation += change.segment<3>(first + 3);
    }
    if (change.size() == 0 || change.cwiseAbs().maxCoeff() < kSmallestStep) return step;
  }
  return max_steps;
}

}  // namespace parkade
