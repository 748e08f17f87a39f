#include "slam/pose_graph/join_parts.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace parkade {
namespace {

/// Vertices that edges hold together.
class Parts {
 public:
  explicit Parts(const PoseGraph& graph)
      : graph_(graph), parent_(graph.vertices.size()), count_(graph.vertices.size()) {
    std::iota(parent_.begin(), parent_.end(), size_t{0});
  }

  /// Whether the edge joins two parts. One that leaves a place open, as gravity does, joins none.
  bool Join(size_t edge) {
    const PoseGraphEdge& ends = graph_.edges[edge];
    const size_t a = RootOf(ends.from), b = RootOf(ends.to);
    if (a == b || !(ConcentrationsOf(ends, graph_.is_planar).tau > 0)) return false;
    parent_[a] = b;
    --count_;
    return true;
  }
  size_t count() const { return count_; }

 private:
  size_t RootOf(size_t vertex) {
    while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
    return vertex;
  }

  const PoseGraph& graph_;
  std::vector<size_t> parent_;
  size_t count_;
};

}  // namespace

void JoinParts(const PoseGraph& graph, const std::vector<double>& likely,
               std::vector<double>& weights) {
  Parts parts(graph);
  std::vector<size_t> order;
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) {
      order.push_back(i);
    } else {
      parts.Join(i);
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return std::pair(!(likely[a] > 0), IdGap(graph, graph.edges[a])) <
           std::pair(!(likely[b] > 0), IdGap(graph, graph.edges[b]));
  });
  for (const size_t i : order)
    if (parts.Join(i)) weights[i] = 1;
}

bool LeavesApart(const PoseGraph& graph, const std::vector<double>& weights) {
  Parts joined(graph), by_all(graph);
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] > 0.5) joined.Join(i);
    by_all.Join(i);
  }
  return joined.count() > by_all.count();
}

}  // namespace parkade
