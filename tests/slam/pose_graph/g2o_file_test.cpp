#include "slam/pose_graph/g2o_file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/slam/worlds/synthetic_pose_graph.h"

namespace parkade {
namespace {

constexpr char kSpatial[] =
    "# a comment\n"
    "VERTEX_SE3:QUAT 3 1 2 3 0 0 0 1\n"
    "VERTEX_SE3:QUAT 4 2 2 3 0 0 0.70710678 0.70710678\r\n"
    "\n"
    "FIX 4\n"
    "EDGE_SE3:QUAT 3 4 1 0 0 0 0 0 1  1 0 0 0 0 0  2 0 0 0 0  3 0 0 0  4 0 0.5  5 0  6";
constexpr char kPlanar[] =
    "EDGE_SE2 7 5 1 2 0.5  10 0.1 0.2 20 0.3 30\n"
    "EDGE_SE2 5 6 1 0 -3.1 1 0 0 1 0 1\n";

std::string ComplaintAbout(const std::string& text) {
  try {
    ReadG2o(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
    return error.what();
  }
  return "";
}

TEST(G2oFile, SpatialGraphIsReadAsWritten) {
  const PoseGraph graph = ReadG2o(kSpatial);

  ASSERT_EQ(graph.vertices.size(), 2u);
  EXPECT_FALSE(graph.is_planar);
  EXPECT_EQ(graph.vertices[0].id, 3);
  EXPECT_FALSE(graph.vertices[0].is_fixed);
  EXPECT_TRUE(graph.vertices[1].is_fixed);
  EXPECT_NEAR(LogSo3(graph.vertices[1].world_from_vertex.rotation).z(), M_PI / 2, 1e-7);
  ASSERT_EQ(graph.edges.size(), 1u);
  const PoseGraphEdge& edge = graph.edges[0];
  EXPECT_TRUE(edge.is_trusted);
  EXPECT_EQ(edge.from, 0u);
  EXPECT_EQ(edge.to, 1u);
  EXPECT_EQ(edge.information(2, 2), 3);
  EXPECT_EQ(edge.information(5, 3), 0.5)
      << "order is translation, rotation; both triangles are filled";
  EXPECT_EQ(edge.information(5, 5), 6);
}

TEST(G2oFile, PlanarGraphWithoutVerticesNamesThemByItsEdges) {
  const PoseGraph graph = ReadG2o(kPlanar);

  EXPECT_TRUE(graph.is_planar);
  ASSERT_EQ(graph.vertices.size(), 3u);
  EXPECT_EQ(graph.vertices[0].id, 5);
  EXPECT_FALSE(graph.edges[0].is_trusted) << "7 and 5 are not consecutive";
  EXPECT_TRUE(graph.edges[1].is_trusted);
  EXPECT_EQ(graph.edges[0].information(0, 5), 0.2);
  EXPECT_EQ(graph.edges[0].information(1, 1), 20);
  EXPECT_EQ(graph.edges[0].information(2, 2), 0);
}

TEST(G2oFile, WhatIsWrittenReadsBackTheSame) {
  for (const bool is_planar : {false, true}) {
    const PoseGraph graph =
        MakeSyntheticGraph({.num_poses = 40, .wrong_share = 0.2, .is_planar = is_planar}).graph;
    const std::string text = WriteG2o(graph);
    const PoseGraph again = ReadG2o(text);
    EXPECT_EQ(again.is_planar, is_planar);
    ASSERT_EQ(again.edges.size(), graph.edges.size());
    for (size_t i = 0; i < graph.edges.size(); ++i) {
      EXPECT_EQ(again.edges[i].is_trusted, graph.edges[i].is_trusted);
      EXPECT_EQ(again.edges[i].information, graph.edges[i].information);
      EXPECT_EQ(again.edges[i].from_from_to.translation, graph.edges[i].from_from_to.translation);
      EXPECT_LT(again.edges[i].from_from_to.rotation.angularDistance(
                    graph.edges[i].from_from_to.rotation),
                1e-12);
    }
  }
}

TEST(G2oFile, EdgesLeftOutBecomeComments) {
  const PoseGraph graph = ReadG2o(kPlanar);
  const std::string text = WriteG2o(graph, {true, false});
  EXPECT_NE(text.find("# rejected: EDGE_SE2 7 5"), std::string::npos);
  EXPECT_EQ(ReadG2o(text).edges.size(), 1u);
}

TEST(G2oFile, EveryComplaintNamesItsLine) {
  const std::string edge = "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n";
  const std::pair<std::string, std::string> cases[] = {
      {"VERTEX_XY 0 1 2\n", "line 1"},
      {edge + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0\n", "line 2"},
      {edge + edge + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1 9\n", "line 3"},
      {"\n# x\n" + edge + "EDGE_SE2 0 1 1 0 nan 1 0 0 1 0 1\n", "line 4"},
      {"EDGE_SE2 0 1 1 0 inf 1 0 0 1 0 1\n", "line 1"},
      {"EDGE_SE2 0 1 1e300 0 0 1 0 0 1 0 1\n", "too large"},
      {"EDGE_SE2 0 1 1 0 0x 1 0 0 1 0 1\n", "line 1"},
      {"EDGE_SE2 0 1.5 1 0 0 1 0 0 1 0 1\n", "line 1"},
      {"EDGE_SE2 0 -1 1 0 0 1 0 0 1 0 1\n", "negative id"},
      {"EDGE_SE2 0 99999999999999999999 1 0 0 1 0 0 1 0 1\n", "line 1"},
      {"EDGE_SE2 1 1 1 0 0 1 0 0 1 0 1\n", "to itself"},
      {"EDGE_SE2 0 1 1 0 0 1 0 0 -1 0 1\n", "positive semidefinite"},
      {"EDGE_SE2 0 1 1 0 0 1 5 0 1 0 1\n", "positive semidefinite"},
      {"VERTEX_SE2 0 0 0 0\nVERTEX_SE2 0 0 0 0\n" + edge, "line 2"},
      {"VERTEX_SE2 0 0 0 0\n" + edge, "line 2 of the g2o file names vertex 1"},
      {edge + "FIX 5\n", "names vertex 5"},
      {edge + "FIX\n", "line 2"},
      {edge + "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n", "mixes"},
      {"VERTEX_SE3:QUAT 0 0 0 0 0 0 0 2\n", "unit length"},
      {"VERTEX_SE2 0 0 0 0\n", "no edges"},
      {"", "no edges"},
  };
  for (const auto& [text, expected] : cases)
    EXPECT_NE(ComplaintAbout(text).find(expected), std::string::npos) << text << "\n"
                                                                      << ComplaintAbout(text);
}

TEST(G2oFile, DamagedTextIsReadOrRefusedButNeverWorse) {
  const std::string texts[] = {kSpatial, kPlanar};
  std::uint32_t random = 7;
  const auto next = [&random] { return random = random * 1664525u + 1013904223u, random >> 8; };
  for (int trial = 0; trial < 4000; ++trial) {
    std::string text = texts[trial % 2];
    for (std::uint32_t change = next() % 4 + 1; change > 0; --change) {
      const size_t at = next() % text.size();
      switch (next() % 3) {
        case 0: text[at] = static_cast<char>(next()); break;
        case 1: text.erase(at, next() % 8); break;
        default: text.insert(at, text.substr(next() % text.size(), next() % 20)); break;
      }
      if (text.empty()) text = "\n";
    }
    try {
      const PoseGraph graph = ReadG2o(text);
      for (const PoseGraphEdge& edge : graph.edges) {
        ASSERT_LT(std::max(edge.from, edge.to), graph.vertices.size());
        ASSERT_TRUE(edge.information.allFinite() && edge.from_from_to.translation.allFinite());
      }
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
    }
  }
}

}  // namespace
}  // namespace parkade
