#include "slam/pose_graph/join_parts.h"

#include <algorithm>
#include <numeric>

namespace parkade {

void JoinParts(const PoseGraph& graph, std::vector<double>& weights) {
  std::vector<size_t> parent(graph.vertices.size()), order;
  std::iota(parent.begin(), parent.end(), size_t{0});
  const auto root_of = [&parent](size_t vertex) {
    while (parent[vertex] != vertex) vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
  };
  const auto joins = [&](size_t i) {
    const size_t a = root_of(graph.edges[i].from), b = root_of(graph.edges[i].to);
    parent[a] = b;
    return a != b;
  };
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) {
      order.push_back(i);
    } else {
      joins(i);
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return IdGap(graph, graph.edges[a]) < IdGap(graph, graph.edges[b]);
  });
  for (const size_t i : order)
    if (joins(i)) weights[i] = 1;
}

}  // namespace parkade
