#include "slam/pose_graph/join_parts.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

/// The world and two drives of three keyframes each, with odometry and gravity; then two loops from
/// drive to drive.
PoseGraph TwoDrives() {
  Matrix6d gravity = Matrix6d::Zero();
  gravity(3, 3) = gravity(4, 4) = 1e6;
  PoseGraph graph;
  graph.vertices = {{-1'000'000, {}, true}, {0, {}, true},          {1, {}, false},
                    {2, {}, false},         {1'000'000, {}, false}, {1'000'001, {}, false},
                    {1'000'002, {}, false}};
  for (size_t i = 1; i < graph.vertices.size(); ++i)
    graph.edges.push_back({0, i, {}, gravity, true});
  for (const size_t i : {1u, 2u, 4u, 5u})
    graph.edges.push_back({i, i + 1, {}, Matrix6d::Identity(), true});
  graph.edges.push_back({1, 5, {}, Matrix6d::Identity(), false});
  graph.edges.push_back({1, 4, {}, Matrix6d::Identity(), false});
  return graph;
}

TEST(JoinParts, GravityLeavesDrivesApart) {
  const PoseGraph graph = TwoDrives();
  std::vector<double> weights(graph.edges.size(), 1);
  weights[10] = weights[11] = 0;
  EXPECT_TRUE(LeavesApart(graph, weights));

  JoinParts(graph, std::vector<double>(weights.size()), weights);

  EXPECT_EQ(weights[10], 0) << "of the farther ids";
  EXPECT_EQ(weights[11], 1);
  EXPECT_FALSE(LeavesApart(graph, weights));
}

TEST(JoinParts, LikelyEdgesJoinFirst) {
  const PoseGraph graph = TwoDrives();
  std::vector<double> weights(graph.edges.size(), 1), likely(graph.edges.size());
  weights[10] = weights[11] = 0;
  likely[10] = 1;

  JoinParts(graph, likely, weights);

  EXPECT_EQ(weights[10], 1) << "of the farther ids";
  EXPECT_EQ(weights[11], 0);
}

TEST(JoinParts, WhatHangsTogetherStaysAsItIs) {
  const PoseGraph graph = TwoDrives();
  std::vector<double> weights(graph.edges.size(), 1);
  weights[11] = 0;
  const std::vector<double> before = weights;
  JoinParts(graph, before, weights);
  EXPECT_EQ(weights, before);
  EXPECT_FALSE(LeavesApart(graph, weights));
}

TEST(JoinParts, HalfBelievedEdgesDoNotJoin) {
  const PoseGraph graph = TwoDrives();
  std::vector<double> weights(graph.edges.size(), 1);
  weights[10] = weights[11] = 0.5;
  EXPECT_TRUE(LeavesApart(graph, weights));
}

TEST(JoinParts, WhatNoEdgeJoinsIsNotLeftApart) {
  PoseGraph graph = TwoDrives();
  graph.edges.resize(10);
  EXPECT_FALSE(LeavesApart(graph, std::vector<double>(graph.edges.size(), 1)));
}

}  // namespace
}  // namespace parkade
