#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "slam/pose_graph/pose_graph.h"

namespace parkade {

/// Reads a pose graph in g2o's text format: VERTEX_SE2 and EDGE_SE2, or
/// VERTEX_SE3:QUAT and EDGE_SE3:QUAT, and FIX; lines that are empty or begin
/// with # are skipped. Vertices keep the order of the file. A file without any
/// vertex gets one per id that its edges name, in the order of the ids, at the
/// origin. Edges between consecutive ids are trusted (odometry).
///
/// Information of a rotation is of the rotation vector, as GTSAM and SE-Sync read it; g2o's own is
/// of the quaternion's vector part, a quarter of it.
///
/// Throws Error{kInvalidInput}, one sentence with the line's number, for a line
/// of another kind, with a wrong count of numbers, a number that is not finite or
/// beyond 1e12 (information: 1e18), a quaternion off unit length by more than 5 %,
/// an information matrix whose block of translation or of rotation is not positive semidefinite, a
/// vertex given twice, an edge or FIX that names no vertex, and for a file without edges.
PoseGraph ReadG2o(std::string_view text);

/// The graph as g2o text, numbers with all their digits. Edges whose flag in `is_left_out` is set
/// (empty: none) become comments.
std::string WriteG2o(const PoseGraph& graph, const std::vector<bool>& is_left_out = {});

}  // namespace parkade
