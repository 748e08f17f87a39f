#include <charconv>

#include "slam/pose_graph/g2o_file.h"

namespace parkade {
namespace {

void Append(std::string& text, double number) {
  char digits[32];
  const auto end =
      std::to_chars(digits, digits + sizeof(digits), number + 0.0).ptr;  // + 0.0: no "-0"
  text.append(1, ' ').append(digits, end);
}

void AppendPose(std::string& text, const Rigid3& pose, bool is_planar) {
  if (is_planar) {
    Append(text, pose.translation.x());
    Append(text, pose.translation.y());
    Append(text, LogSo3(pose.rotation).z());
    return;
  }
  for (const double coordinate : pose.translation) Append(text, coordinate);
  for (const double coefficient : pose.rotation.coeffs()) Append(text, coefficient);
}

void AppendInformation(std::string& text, const Matrix6d& information, bool is_planar) {
  const std::vector<int> rows =
      is_planar ? std::vector<int>{0, 1, 5} : std::vector<int>{0, 1, 2, 3, 4, 5};
  for (size_t i = 0; i < rows.size(); ++i)
    for (size_t j = i; j < rows.size(); ++j) Append(text, information(rows[i], rows[j]));
}

}  // namespace

std::string WriteG2o(const PoseGraph& graph, const std::vector<bool>& is_left_out) {
  const char* const vertex_tag = graph.is_planar ? "VERTEX_SE2 " : "VERTEX_SE3:QUAT ";
  const char* const edge_tag = graph.is_planar ? "EDGE_SE2 " : "EDGE_SE3:QUAT ";
  std::string text;
  for (const PoseGraphVertex& vertex : graph.vertices) {
    text += vertex_tag + std::to_string(vertex.id);
    AppendPose(text, vertex.world_from_vertex, graph.is_planar);
    text += '\n';
  }
  for (const PoseGraphVertex& vertex : graph.vertices)
    if (vertex.is_fixed) text += "FIX " + std::to_string(vertex.id) + "\n";
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const PoseGraphEdge& edge = graph.edges[i];
    if (!is_left_out.empty() && is_left_out[i]) text += "# rejected: ";
    text += edge_tag + std::to_string(graph.vertices[edge.from].id) + " " +
            std::to_string(graph.vertices[edge.to].id);
    AppendPose(text, edge.from_from_to, graph.is_planar);
    AppendInformation(text, edge.information, graph.is_planar);
    text += '\n';
  }
  return text;
}

}  // namespace parkade
