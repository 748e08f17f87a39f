#include "slam/pose_graph/robust_pose_graph.h"

#include <limits>

#include "core/error.h"
#include "core/math/decompositions.h"
#include "core/math/statistics.h"
#include "slam/pose_graph/chi_squared.h"
#include "slam/pose_graph/join_parts.h"
#include "slam/pose_graph/loop_support.h"
#include "slam/pose_graph/pose_graph_start.h"

namespace parkade {
namespace {

constexpr int kMaxRounds = 200;
constexpr int kStepsPerRound = 4;  // the weights change before a round has converged anyway
constexpr double kRoundTolerance = 1e-5;
constexpr double kMuNearSolution = 0.01;  // loops off by up to 10 times their bound still pull
constexpr size_t kFewLoops = 300;
constexpr double kLessNoise = 0.7;  // scale of sigma below which the first, wide bound was too wide
constexpr double kClearlyLess = 0.8;  // of one scale to the one before
constexpr int kPartnersInGroup[] = {3, 6, 12};
constexpr double kNearlyAll = 0.95;
constexpr int kMaxRestarts = 3;
constexpr int kMaxAdaptions = 6;
constexpr double kNoiseMargin =
    3;  // above what the median shows: errors of real loops have long tails

/// Medians of chi^2 with 1 to 6 degrees of freedom.
constexpr double kChiSquaredMedian[] = {0.4549, 1.3863, 2.3660, 3.3567, 4.3515, 5.3481};

int RankOf(const Matrix6d& square_root_weight) {
  const Vector6d eigenvalues =
      SymmetricEigenvalues(square_root_weight.transpose() * square_root_weight);
  return std::max(1,
                  static_cast<int>((eigenvalues.array() > 1e-9 * eigenvalues.maxCoeff()).count()));
}

/// How many numbers an edge measures under the objective.
int DegreesOfFreedom(const PoseGraph& graph, const PoseGraphEdge& edge,
                     PoseGraphObjective objective) {
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
      : graph_(graph),
        options_(options),
        problem_(graph, options.graph.Objective()),
        weights_(graph.edges.size(), 1) {
    for (const PoseGraphEdge& edge : graph.edges) {
      const int degrees = DegreesOfFreedom(graph, edge, options.graph.Objective());
      bounds_.push_back(ChiSquared99(degrees));
      medians_.push_back(kChiSquaredMedian[degrees - 1]);
    }
  }

  RobustPoseGraphSummary Run() {
    RobustPoseGraphSummary summary;
    ContinueFromBestStart(summary);
    AdaptNoise(summary);
    for (int i = 0; i < kMaxRestarts && summary.noise_scale < kLessNoise; ++i) {
      const double before = summary.noise_scale;
      RestartWithLessNoise(summary);
      AdaptNoise(summary);
      if (summary.noise_scale > kClearlyLess * before) break;
    }
    Settle(summary);
    return summary;
  }

  std::vector<Rigid3> Poses() const { return problem_.Poses(); }

 private:
  /// Lowers the bound to what the accepted loops show, in steps: the fewer wrong loops still pull,
  /// the closer the right ones come.
  void AdaptNoise(RobustPoseGraphSummary& summary) {
    for (int i = 0; options_.adapts_noise && i < kMaxAdaptions; ++i) {
      const double shown = NoiseScale();
      if (shown > kClearlyLess * summary.noise_scale) break;
      summary.noise_scale = std::max(shown, summary.noise_scale / 4);
      Continue(kMuNearSolution, summary);
    }
  }

  double BoundOf(size_t edge, double noise_scale) const {
    return noise_scale * noise_scale * bounds_[edge];
  }

  /// Where a continuation ended.
  struct Reached {
    std::vector<Rigid3> poses;
    std::vector<double> weights;
    double cost = std::numeric_limits<double>::infinity();  ///< truncated
  };

  Reached Current(double noise_scale) const {
    return {problem_.Poses(), weights_, TruncatedCost(noise_scale)};
  }

  void Restore(const Reached& reached) {
    problem_.SetPoses(reached.poses);
    weights_ = reached.weights;
  }

  /// 1 for trusted and supported edges; empty where no edge is supported.
  std::vector<double> WeightsOfSupported(double max_noise_scale, int min_partners) const {
    const std::vector<bool> is_supported =
        FindSupportedLoops(graph_, max_noise_scale, min_partners);
    std::vector<double> weights;
    for (size_t i = 0; i < graph_.edges.size(); ++i)
      weights.push_back(graph_.edges[i].is_trusted || is_supported[i] ? 1 : 0);
    if (std::count(is_supported.begin(), is_supported.end(), true) == 0) weights.clear();
    return weights;
  }

  /// Continues from `weights`; takes the result where its truncated cost is lower than `best`'s.
  /// Parts that `weights` leaves apart are joined by `likely` edges where there are some.
  void Try(std::vector<double> weights, const std::vector<double>& likely, double mu,
           RobustPoseGraphSummary& summary, Reached& best) {
    JoinParts(graph_, likely, weights);
    Begin(weights);
    Continue(mu, summary);
    Reached reached = Current(summary.noise_scale);
    if (best.poses.empty() || reached.cost < best.cost) best = std::move(reached);
  }

  /// Whether nearly all edges chosen by `weights` were believed in the end, and no part of the
  /// graph was lost: to a large site a drive is less than what may be wrong.
  bool Believes(const Reached& reached, const std::vector<double>& weights) const {
    if (LeavesApart(graph_, reached.weights)) return false;
    size_t num_chosen = 0, num_believed = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
      num_chosen += weights[i] > 0;
      num_believed += weights[i] > 0 && reached.weights[i] > 0.5;
    }
    return static_cast<double>(num_believed) >= kNearlyAll * static_cast<double>(num_chosen);
  }

  /// Tries the loops that support each other in threes, and where the result does not explain
  /// these, in larger groups: rows that look alike agree with each other too, but not with as many.
  /// Then those with a single partner if they are not explained yet.
  void TrySupported(RobustPoseGraphSummary& summary, Reached& best) {
    const std::vector<double> pairs = WeightsOfSupported(summary.noise_scale, 1);
    if (pairs.empty()) return;
    for (const int num_partners : kPartnersInGroup) {
      const std::vector<double> groups = WeightsOfSupported(summary.noise_scale, num_partners);
      if (groups.empty()) break;
      Try(groups, pairs, kMuNearSolution, summary, best);
      if (Believes(best, groups)) break;
    }
    if (best.poses.empty() || !Believes(best, pairs))
      Try(pairs, pairs, kMuNearSolution, summary, best);
  }

  /// Loops that support each other are a good start, and the only one that is quick where many
  /// wrong ones join everything with everything. Few loops may have no partner: then all of them
  /// are a start, as in the paper.
  void ContinueFromBestStart(RobustPoseGraphSummary& summary) {
    Reached best;
    TrySupported(summary, best);
    const auto num_loops =
        static_cast<size_t>(std::count_if(graph_.edges.begin(), graph_.edges.end(),
                                          [](const PoseGraphEdge& e) { return !e.is_trusted; }));
    const std::vector<double> all(graph_.edges.size(), 1);
    if (best.poses.empty() || num_loops <= kFewLoops) Try(all, all, 0, summary, best);
    Restore(best);
  }

  /// What was wrong at the first, wide bound may have bent the graph so that right loops were lost.
  /// With the noise that is known by now, fewer wrong ones find a partner.
  void RestartWithLessNoise(RobustPoseGraphSummary& summary) {
    Reached best = Current(summary.noise_scale);
    TrySupported(summary, best);
    Restore(best);
  }

  /// Solves with these weights from the relaxation.
  void Begin(const std::vector<double>& weights) {
    weights_ = weights;
    problem_.SetWeights(weights_);
    const std::vector<Rigid3> relaxed = RelaxChordally(graph_, weights_);
    problem_.SetPoses(relaxed.empty() ? ChainEdges(graph_) : relaxed);
    problem_.Solve(kStepsPerRound, kRoundTolerance);
  }

  /// What truncated least squares minimizes.
  double TruncatedCost(double noise_scale) const {
    const std::vector<double> squared_errors = problem_.SquaredErrors();
    double cost = 0;
    for (size_t i = 0; i < squared_errors.size(); ++i)
      cost += graph_.edges[i].is_trusted ? squared_errors[i]
                                         : std::min(squared_errors[i], BoundOf(i, noise_scale));
    return cost;
  }

  /// Lets the surrogate approach truncation, from `mu` on; 0: from where it is convex.
  void Continue(double mu, RobustPoseGraphSummary& summary) {
    std::vector<double> squared_errors = problem_.SquaredErrors();
    if (mu == 0) {
      double worst = 1;  // in units of the bound
      for (size_t i = 0; i < squared_errors.size(); ++i)
        if (!graph_.edges[i].is_trusted)
          worst = std::max(worst, squared_errors[i] / BoundOf(i, summary.noise_scale));
      mu = 1 / (2 * worst - 1);
    }
    for (int round = 0; round < kMaxRounds; ++round, mu *= options_.mu_step) {
      bool is_binary = true;
      for (size_t i = 0; i < weights_.size(); ++i) {
        if (graph_.edges[i].is_trusted) continue;
        weights_[i] = WeightOf(squared_errors[i], BoundOf(i, summary.noise_scale), mu);
        is_binary = is_binary && (weights_[i] == 0 || weights_[i] == 1);
      }
      problem_.SetWeights(weights_);
      problem_.Solve(kStepsPerRound, kRoundTolerance);
      ++summary.num_rounds;
      squared_errors = problem_.SquaredErrors();
      if (is_binary) break;
    }
  }

  /// Factor on all sigmas with which the bound would lie well above the errors of the accepted
  /// loops.
  double NoiseScale() const {
    const std::vector<double> squared_errors = problem_.SquaredErrors();
    std::vector<double> ratios;  // to the median that their information says
    for (size_t i = 0; i < weights_.size(); ++i)
      if (!graph_.edges[i].is_trusted && weights_[i] > 0.5)
        ratios.push_back(squared_errors[i] / medians_[i]);
    if (ratios.size() < 20) return 1;
    return kNoiseMargin * std::sqrt(Median(std::move(ratios)));
  }

  /// Solves with the accepted edges alone, from the better of two starts, and accepts anew by the
  /// outcome.
  void Settle(RobustPoseGraphSummary& summary) {
    for (int pass = 0; pass < 3; ++pass) {
      for (double& weight : weights_) weight = weight > 0.5 ? 1 : 0;
      problem_.SetWeights(weights_);
      const std::vector<Rigid3> current = problem_.Poses(),
                                relaxed = RelaxChordally(graph_, weights_);
      const double cost = problem_.Cost();
      if (!relaxed.empty()) problem_.SetPoses(relaxed);
      if (problem_.Cost() > cost) problem_.SetPoses(current);
      summary.solve =
          problem_.Solve(options_.graph.max_iterations, options_.graph.relative_tolerance);
      const std::vector<double> squared_errors = problem_.SquaredErrors();
      summary.weights = weights_;
      for (size_t i = 0; i < weights_.size(); ++i)
        if (!graph_.edges[i].is_trusted)
          weights_[i] = squared_errors[i] < BoundOf(i, summary.noise_scale) ? 1 : 0;
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

RobustPoseGraphSummary OptimizePoseGraphRobustly(const RobustPoseGraphOptions& options,
                                                 PoseGraph& graph) {
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
