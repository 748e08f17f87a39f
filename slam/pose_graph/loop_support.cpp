#include "slam/pose_graph/loop_support.h"

#include <limits>
#include <numeric>

#include "slam/pose_graph/chi_squared.h"
#include "slam/pose_graph/pose_graph_start.h"

namespace parkade {
namespace {

constexpr int kWindow = 10;  // [vertices] along the odometry, at each end

/// Variances of an edge or of a stretch of odometry, the same in all directions.
struct Variances {
  double rotation = 0;     ///< [rad^2]
  double translation = 0;  ///< [m^2]
};

Variances VariancesOf(const PoseGraphEdge& edge, bool is_planar) {
  const EdgeConcentrations concentrations = ConcentrationsOf(edge, is_planar);
  constexpr double kUnknown = 1e3;  // sums of it must not drown the others
  return {concentrations.kappa > 0 ? 0.5 / concentrations.kappa : kUnknown,
          concentrations.tau > 0 ? 1 / concentrations.tau : kUnknown};
}

/// The vertices in the order of their ids, and what odometry knows between them.
struct OdometryLine {
  std::vector<int> place;         ///< of each vertex: its position along the line
  std::vector<Variances> summed;  ///< per position: from the beginning of the line
  std::vector<Rigid3> poses;      ///< per position: chained odometry
};

OdometryLine LineUp(const PoseGraph& graph) {
  const size_t count = graph.vertices.size();
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(),
            [&](size_t a, size_t b) { return graph.vertices[a].id < graph.vertices[b].id; });
  OdometryLine line;
  line.place.resize(count);
  for (size_t i = 0; i < count; ++i) line.place[order[i]] = static_cast<int>(i);

  std::vector<Variances> steps(count);  // of the step that leads to a position from the one before
  std::vector<bool> has_step(count);
  for (const PoseGraphEdge& edge : graph.edges) {
    const auto [first, last] = std::minmax({line.place[edge.from], line.place[edge.to]});
    if (!edge.is_trusted || last != first + 1) continue;
    steps[static_cast<size_t>(last)] = VariancesOf(edge, graph.is_planar);
    has_step[static_cast<size_t>(last)] = true;
  }
  // Where no trusted edge leads on, other edges bridge the gap in the chain.
  Variances bridge;
  for (const PoseGraphEdge& edge : graph.edges) {
    const Variances variances = VariancesOf(edge, graph.is_planar);
    bridge = {std::max(bridge.rotation, variances.rotation),
              std::max(bridge.translation, variances.translation)};
  }
  const std::vector<Rigid3> chained = ChainEdges(graph);
  Variances sum;
  for (size_t i = 0; i < count; ++i) {
    const Variances& step = has_step[i] ? steps[i] : bridge;
    sum.rotation += step.rotation;
    sum.translation += step.translation;
    line.summed.push_back(sum);
    line.poses.push_back(chained[order[i]]);
  }
  return line;
}

/// A loop from the earlier to the later vertex.
struct Loop {
  size_t edge;
  size_t first, last;  ///< positions along the line
  Rigid3 first_from_last;
  Variances variances;
};

Variances Between(const OdometryLine& line, size_t a, size_t b) {
  const Variances &from = line.summed[std::min(a, b)], &to = line.summed[std::max(a, b)];
  return {to.rotation - from.rotation, to.translation - from.translation};
}

/// Squared error around two loops in units of its variance, about chi^2 with 6 degrees of freedom.
double Disagreement(const OdometryLine& line, const Loop& a, const Loop& b) {
  const Rigid3 a_from_b = line.poses[a.first].Inverse() * line.poses[b.first];
  const Rigid3 b_from_a = line.poses[b.last].Inverse() * line.poses[a.last];
  PoseGraphEdge measured;
  measured.from_from_to = a.first_from_last;
  const Vector6d error = RelativePoseError(measured, {}, a_from_b * b.first_from_last * b_from_a);
  const Variances before = Between(line, a.first, b.first), after = Between(line, a.last, b.last);
  const double rotation =
      before.rotation + after.rotation + a.variances.rotation + b.variances.rotation;
  const double lever = b.first_from_last.translation.norm() + b_from_a.translation.norm() +
                       a_from_b.translation.norm();
  const double translation = before.translation + after.translation + a.variances.translation +
                             b.variances.translation + lever * lever * rotation;
  return error.tail<3>().squaredNorm() / rotation + error.head<3>().squaredNorm() / translation;
}

std::vector<Loop> LoopsOf(const PoseGraph& graph, const OdometryLine& line) {
  std::vector<Loop> loops;
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const PoseGraphEdge& edge = graph.edges[i];
    if (edge.is_trusted) continue;
    const auto from = static_cast<size_t>(line.place[edge.from]),
               to = static_cast<size_t>(line.place[edge.to]);
    loops.push_back({i, std::min(from, to), std::max(from, to),
                     from < to ? edge.from_from_to : edge.from_from_to.Inverse(),
                     VariancesOf(edge, graph.is_planar)});
  }
  std::sort(loops.begin(), loops.end(), [](const Loop& a, const Loop& b) {
    return std::tie(a.first, a.last, a.edge) < std::tie(b.first, b.last, b.edge);
  });
  return loops;
}

/// Two loops near each other along the drive at both ends.
struct LoopPair {
  size_t a, b;
  double disagreement;
};

std::vector<LoopPair> PairsOf(const OdometryLine& line, const std::vector<Loop>& loops) {
  std::vector<LoopPair> pairs;
  for (size_t a = 0; a < loops.size(); ++a) {
    for (size_t b = a + 1; b < loops.size() && loops[b].first - loops[a].first <= kWindow; ++b) {
      const size_t gap =
          std::max(loops[a].last, loops[b].last) - std::min(loops[a].last, loops[b].last);
      if (gap <= kWindow) pairs.push_back({a, b, Disagreement(line, loops[a], loops[b])});
    }
  }
  return pairs;
}

/// Noise that the better part of the loops shows, relative to what their information says.
double NoiseScaleOf(const std::vector<LoopPair>& pairs, size_t num_loops) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::vector<double> least(num_loops, kNone);
  for (const LoopPair& pair : pairs)
    for (const size_t loop : {pair.a, pair.b})
      least[loop] = std::min(least[loop], pair.disagreement);
  std::erase(least, kNone);
  std::sort(least.begin(), least.end());
  // A quarter of the loops is taken to be right; the best of several partners agrees better than
  // one would, which the factor makes good.
  constexpr double kMargin = 3;
  const double low = least.empty() ? 1 : least[least.size() / 4];
  return std::clamp(kMargin * std::sqrt(low / 6), 1e-6, 1.0);
}

/// Loops left when all that have fewer than `min_partners` partners among those left are taken
/// away, again and again: the core of the graph whose edges are `pairs`.
std::vector<bool> CoreOf(const std::vector<LoopPair>& pairs, size_t num_loops, int min_partners) {
  std::vector<std::vector<size_t>> partners(num_loops);
  for (const LoopPair& pair : pairs) {
    partners[pair.a].push_back(pair.b);
    partners[pair.b].push_back(pair.a);
  }
  std::vector<int> num_left;
  std::vector<size_t> to_remove;
  std::vector<bool> is_left(num_loops, true);
  const auto remove_if_lonely = [&](size_t loop) {
    if (!is_left[loop] || num_left[loop] >= min_partners) return;
    is_left[loop] = false;
    to_remove.push_back(loop);
  };
  for (const std::vector<size_t>& of_loop : partners)
    num_left.push_back(static_cast<int>(of_loop.size()));
  for (size_t i = 0; i < num_loops; ++i) remove_if_lonely(i);
  while (!to_remove.empty()) {
    const size_t loop = to_remove.back();
    to_remove.pop_back();
    for (const size_t partner : partners[loop]) {
      --num_left[partner];
      remove_if_lonely(partner);
    }
  }
  return is_left;
}

}  // namespace

std::vector<bool> FindSupportedLoops(const PoseGraph& graph, double max_noise_scale,
                                     int min_partners) {
  const OdometryLine line = LineUp(graph);
  const std::vector<Loop> loops = LoopsOf(graph, line);
  std::vector<LoopPair> pairs = PairsOf(line, loops);
  const double noise_scale = std::min(max_noise_scale, NoiseScaleOf(pairs, loops.size()));
  const double bound = noise_scale * noise_scale * ChiSquared99(graph.is_planar ? 3 : 6);
  std::erase_if(pairs, [bound](const LoopPair& pair) { return !(pair.disagreement < bound); });
  const std::vector<bool> is_left = CoreOf(pairs, loops.size(), min_partners);
  std::vector<bool> is_supported(graph.edges.size());
  for (size_t i = 0; i < loops.size(); ++i) is_supported[loops[i].edge] = is_left[i];
  return is_supported;
}

}  // namespace parkade
