#include <gtest/gtest.h>

#include "mapping/mesh/deform_mesh.h"
#include "slam/pose_graph/optimize_pose_graph.h"
#include "tests/mapping/worlds/test_surfaces.h"
#include "tests/slam/worlds/synthetic_pose_graph.h"

namespace parkade {
namespace {

TEST(JointSolution, WhereGroundHardlyCountsItIsThatOfThePoseGraph) {
  SyntheticGraph made = MakeSyntheticGraph({.num_poses = 200});
  PoseGraph& graph = made.graph;
  std::vector<FreeKeyframe> keyframes;
  for (const PoseGraphVertex& vertex : graph.vertices)
    keyframes.push_back({vertex.world_from_vertex, vertex.world_from_vertex, keyframes.empty()});
  std::vector<DeformationMeasurement> measurements;
  for (const PoseGraphEdge& edge : graph.edges)
    measurements.push_back({edge.from, edge.to, edge.from_from_to, edge.information});
  TriangleMesh mesh;
  AddRectangle(mesh, -100, -100, 100, 100, 0);

  const JointDeformation joint =
      DeformJointly(mesh, keyframes, measurements, {.spacing = 10, .ground_share = 1e-9});

  PoseGraphOptions by_ceres;
  by_ceres.objective = "information";
  EXPECT_GT(PositionError(made.truth, graph), 0.3) << "odometry alone";
  OptimizePoseGraph(by_ceres, graph);
  double apart = 0;
  for (size_t i = 0; i < graph.vertices.size(); ++i)
    apart = std::max(
        apart, (joint.to_from_body[i].translation - graph.vertices[i].world_from_vertex.translation)
                   .norm());
  EXPECT_LT(apart, 0.005);
}

}  // namespace
}  // namespace parkade
