#include "slam/robust_pose_graph.h"

#include <Eigen/Eigenvalues>

#include "core/error.h"
#include "slam/pose_graph_start.h"

namespace parkade {
namespace {

constexpr int kMaxRounds = 200;
constexpr int kStepsPerRound = 4;  // the weights change before a round has converged anyway

/// Medians of chi^2 with 1 to 6 degrees of freedom.
constexpr double kChiSquaredMedian[] = {0.4549, 1.3863, 2.3660, 3.3567, 4.3515, 5.3481};

int RankOf(const Matrix6d& square_root_weight) {
  const Vector6d eigenvalues = Eigen::SelfAdjointEigenSolver<Matrix6d>(
                                   square_root_weight.transpose() * square_root_weight, Eigen::EigenvaluesOnly)
                                   .eigenvalues();
  return std::max(1, static_cast<int>((eigenvalues.array() > 1e-9 * eigenvalues.maxCoeff()).count()));
}

/// How many numbers an edge measures under the objective.
int DegreesOfFreedom(const PoseGraph& graph, const PoseGraphEdge& edge, PoseGraphObjective objective) {
  const int rank = RankOf(SquareRootWeight(graph, edge, objective));
  return graph.is_planar ? std::min(rank, 3) : rank;
}

/// Weight of an edge under the truncated least squares surrogate. RA-L 2020, eq. 14.
double WeightOf(double squared_error, double bound, double mu) {
  if (squared_error >= (mu + 1) / mu * bound) return 0;
  if (squared_error <= mu / (mu + 1) * bound) return 1;
  return std::sqrt(bound * mu * (mu + 1) / squared_error) - mu;
}

/// The continuation on one problem.
class GraduatedNonConvexity {
 public:
  GraduatedNonConvexity(const PoseGraph& graph, const RobustPoseGraphOptions& options)
      : graph_(graph), options_(options), problem_(graph, options.graph.Objective()), weights_(graph.edges.size(), 1) {
    for (const PoseGraphEdge& edge : graph.edges) {
      const int rank = DegreesOfFreedom(graph, edge, options.graph.Objective());
      bounds_.push_back(ChiSquared99(rank));
      medians_.push_back(kChiSquaredMedian[rank - 1]);
    }
  }

  RobustPoseGraphSummary Run() {
    RobustPoseGraphSummary summary;
    Continue(summary);
    if (options_.adapts_noise) {
      for (int i = 0; i < 5; ++i) {
        const double scale = std::min(1.0, NoiseScale());
        if (scale > 0.8 * summary.noise_scale) break;
        summary.noise_scale = scale;
        Continue(summary);
      }
    }
    Settle(summary);
    return summary;
  }

  std::vector<Rigid3> Poses() const { return problem_.Poses(); }

 private:
  double BoundOf(size_t edge, double noise_scale) const { return noise_scale * noise_scale * bounds_[edge]; }

  /// From all edges down to truncation.
  void Continue(RobustPoseGraphSummary& summary) {
    std::fill(weights_.begin(), weights_.end(), 1);
    problem_.SetWeights(weights_);
    const std::vector<Rigid3> relaxed = RelaxChordally(graph_);
    problem_.SetPoses(relaxed.empty() ? ChainEdges(graph_) : relaxed);
    problem_.Solve(kStepsPerRound, options_.graph.relative_tolerance);

    std::vector<double> squared_errors = problem_.SquaredErrors();
    double worst = 0;  // in units of the bound
    for (size_t i = 0; i < squared_errors.size(); ++i)
      if (!graph_.edges[i].is_trusted) worst = std::max(worst, squared_errors[i] / BoundOf(i, summary.noise_scale));
    if (worst <= 1) return;
    double mu = 1 / std::max(2 * worst - 1, 1e-9);
    for (int round = 0; round < kMaxRounds; ++round, mu *= options_.mu_step) {
      bool is_binary = true;
      for (size_t i = 0; i < weights_.size(); ++i) {
        if (graph_.edges[i].is_trusted) continue;
        weights_[i] = WeightOf(squared_errors[i], BoundOf(i, summary.noise_scale), mu);
        is_binary = is_binary && (weights_[i] == 0 || weights_[i] == 1);
      }
      problem_.SetWeights(weights_);
      problem_.Solve(kStepsPerRound, 1e-5);
      ++summary.num_rounds;
      squared_errors = problem_.SquaredErrors();
      if (is_binary && mu > 1) break;
    }
  }

  /// Sigma of the accepted loops relative to what their information says, from the median of their errors.
  double NoiseScale() const {
    const std::vector<double> squared_errors = problem_.SquaredErrors();
    std::vector<double> ratios;
    for (size_t i = 0; i < weights_.size(); ++i)
      if (!graph_.edges[i].is_trusted && weights_[i] > 0.5) ratios.push_back(squared_errors[i] / medians_[i]);
    if (ratios.size() < 10) return 1;
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    return std::sqrt(*middle);
  }

  /// Solves with the accepted edges alone, from the better of two starts, and accepts anew by the outcome.
  void Settle(RobustPoseGraphSummary& summary) {
    for (int pass = 0; pass < 3; ++pass) {
      for (double& weight : weights_) weight = weight > 0.5 ? 1 : 0;
      problem_.SetWeights(weights_);
      const std::vector<Rigid3> current = problem_.Poses(), relaxed = RelaxChordally(graph_, weights_);
      const double cost = problem_.Cost();
      if (!relaxed.empty()) problem_.SetPoses(relaxed);
      if (problem_.Cost() > cost) problem_.SetPoses(current);
      summary.solve = problem_.Solve(options_.graph.max_iterations, options_.graph.relative_tolerance);
      const std::vector<double> squared_errors = problem_.SquaredErrors();
      summary.weights = weights_;
      for (size_t i = 0; i < weights_.size(); ++i)
        if (!graph_.edges[i].is_trusted) weights_[i] = squared_errors[i] < BoundOf(i, summary.noise_scale) ? 1 : 0;
      if (weights_ == summary.weights) break;
    }
    summary.solve.start = "robust";
  }

  const PoseGraph& graph_;
  const RobustPoseGraphOptions& options_;
  PoseGraphProblem problem_;
  std::vector<double> weights_;  ///< per edge
  std::vector<double> bounds_;   ///< per edge, on the squared error
  std::vector<double> medians_;  ///< per edge, expected of the squared error
};

}  // namespace

void RobustPoseGraphOptions::Validate() const {
  graph.Validate();
  Require(mu_step > 1, ErrorCode::kUsage, "mu_step of a robust pose graph must be greater than 1");
}

double ChiSquared99(int degrees_of_freedom) {
  constexpr double kQuantiles[] = {6.6349, 9.2103, 11.3449, 13.2767, 15.0863, 16.8119};
  return kQuantiles[std::clamp(degrees_of_freedom, 1, 6) - 1];
}

RobustPoseGraphSummary OptimizePoseGraphRobustly(const RobustPoseGraphOptions& options, PoseGraph& graph) {
  options.Validate();
  GraduatedNonConvexity search(graph, options);
  RobustPoseGraphSummary summary = search.Run();
  const std::vector<Rigid3> poses = search.Poses();
  for (size_t i = 0; i < poses.size(); ++i) graph.vertices[i].world_from_vertex = poses[i];
  for (const PoseGraphEdge& edge : graph.edges)
    summary.chi_squared.push_back(SquaredError(graph, edge, options.graph.Objective()));
  return summary;
}

}  // namespace parkade
