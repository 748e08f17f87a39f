#include "slam/pose_graph/pose_graph.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "core/error.h"
#include "core/files/file.h"
#include "slam/factors/relative_pose_cost.h"
#include "slam/pose_graph/g2o_file.h"
#include "slam/pose_graph/optimize_pose_graph.h"
#include "slam/pose_graph/pose_graph_start.h"
#include "tests/slam/worlds/synthetic_pose_graph.h"
#include "tests/support/check_jacobian.h"

namespace parkade {
namespace {

std::filesystem::path SharedGraph(const std::string& name) {
  const char* shared = std::getenv("PARKADE_SHARED_DATA");
  return std::filesystem::path(shared ? shared : "../shared/data") / "g2o" / name;
}

TEST(RelativePoseCost, JacobiansMatchFiniteDifferences) {
  SyntheticGraph made =
      MakeSyntheticGraph({.num_poses = 60, .translation_sigma = 0.5, .rotation_sigma = 0.4});
  const PoseManifold spatial;
  const PlanarPoseManifold planar;
  for (size_t i = 0; i < made.graph.edges.size(); ++i) {
    PoseGraphEdge& edge = made.graph.edges[i];
    edge.information(0, 4) = edge.information(4, 0) = 0.7;
    const RelativePoseCost cost(
        edge.from_from_to, SquareRootWeight(made.graph, edge, PoseGraphObjective::kInformation));
    for (const ceres::Manifold* manifold : {static_cast<const ceres::Manifold*>(&spatial),
                                            static_cast<const ceres::Manifold*>(&planar)}) {
      std::vector<std::vector<double>> parameters(2, std::vector<double>(kPoseSize));
      PoseToParameters(made.truth[edge.from], parameters[0].data());
      PoseToParameters(made.truth[edge.to], parameters[1].data());
      EXPECT_LT(JacobianError(cost, parameters, {manifold, manifold}), 1e-6) << "edge " << i;
    }
  }
}

TEST(PoseGraph, ChordalObjectiveIsTheSumOfMatrixDistances) {
  const SyntheticGraph made = MakeSyntheticGraph({.num_poses = 60, .rotation_sigma = 0.2});
  double expected = 0;
  for (const PoseGraphEdge& edge : made.graph.edges) {
    const Rigid3 &from = made.truth[edge.from], &to = made.truth[edge.to];
    const double kappa = 3 / (2 * edge.information.bottomRightCorner<3, 3>().inverse().trace());
    const double tau = 3 / edge.information.topLeftCorner<3, 3>().inverse().trace();
    const Eigen::Matrix3d turned =
        from.rotation.toRotationMatrix() * edge.from_from_to.rotation.toRotationMatrix();
    expected += kappa * (to.rotation.toRotationMatrix() - turned).squaredNorm() +
                tau * (to.translation - from * edge.from_from_to.translation).squaredNorm();
  }
  PoseGraph at_truth = made.graph;
  for (size_t i = 0; i < made.truth.size(); ++i)
    at_truth.vertices[i].world_from_vertex = made.truth[i];

  EXPECT_NEAR(ObjectiveOf(at_truth, PoseGraphObjective::kChordal), expected, 1e-9 * expected);
}

TEST(PoseGraph, WithoutNoiseEveryStartIsTheTruth) {
  for (const bool is_planar : {false, true}) {
    const SyntheticGraph made = MakeSyntheticGraph({.num_poses = 80,
                                                    .translation_sigma = 1e-9,
                                                    .rotation_sigma = 1e-9,
                                                    .is_planar = is_planar});
    for (const std::vector<Rigid3>& poses : {ChainEdges(made.graph), RelaxChordally(made.graph)}) {
      ASSERT_EQ(poses.size(), made.truth.size());
      for (size_t i = 0; i < poses.size(); ++i) {
        EXPECT_LT((poses[i].translation - made.truth[i].translation).norm(), 1e-5);
        EXPECT_LT(poses[i].rotation.angularDistance(made.truth[i].rotation), 1e-5);
      }
    }
  }
}

TEST(PoseGraph, LoopsMakeADriveBetterThanItsOdometry) {
  for (const bool is_planar : {false, true}) {
    SyntheticGraph made = MakeSyntheticGraph({.is_planar = is_planar});
    const double before = PositionError(made.truth, made.graph);

    const PoseGraphSummary summary = OptimizePoseGraph({}, made.graph);

    EXPECT_TRUE(summary.has_converged);
    EXPECT_LT(PositionError(made.truth, made.graph), 0.7 * before);
    const double edges = static_cast<double>(made.graph.edges.size()),
                 poses = static_cast<double>(made.truth.size());
    if (!is_planar) {
      EXPECT_NEAR(summary.final_cost / (6 * (edges - poses + 1)), 1, 0.2)
          << "chi^2 per degree of freedom";
    }
    if (is_planar) {
      for (const PoseGraphVertex& vertex : made.graph.vertices) {
        EXPECT_EQ(vertex.world_from_vertex.translation.z(), 0);
        EXPECT_EQ(vertex.world_from_vertex.rotation.x(), 0);
      }
    }
  }
}

TEST(PoseGraph, BothObjectivesAndAllStartsAgreeWhereNoiseIsIsotropic) {
  const SyntheticGraph made = MakeSyntheticGraph({});
  PoseGraphOptions options;
  PoseGraph reference = made.graph;
  const double cost = OptimizePoseGraph(options, reference).final_cost;
  for (const char* objective : {"chordal", "information"})
    for (const char* start : {"best", "chordal", "odometry", "given"}) {
      options.objective = objective;
      options.start = start;
      PoseGraph graph = made.graph;
      EXPECT_NEAR(OptimizePoseGraph(options, graph).final_cost, cost, 1e-5 * cost)
          << objective << " " << start;
    }
}

TEST(PoseGraph, FixedVerticesStayAndPartsAreHeldOneByOne) {
  SyntheticGraph made = MakeSyntheticGraph({.num_poses = 80});
  made.graph.vertices[10].is_fixed = made.graph.vertices[70].is_fixed = true;
  // A second part, and a vertex alone.
  made.graph.vertices.push_back({500, {}, false});
  made.graph.vertices.push_back({501, {}, false});
  made.graph.vertices.push_back({900, {ExpSo3({0, 0, 1}), {5, 5, 5}}, false});
  PoseGraphEdge edge = made.graph.edges.front();
  edge.from = 80;
  edge.to = 81;
  made.graph.edges.push_back(edge);
  const PoseGraph before = made.graph;

  OptimizePoseGraph({}, made.graph);

  for (const size_t i : {10u, 70u, 80u, 82u}) {
    const Rigid3 &was = before.vertices[i].world_from_vertex,
                 &is = made.graph.vertices[i].world_from_vertex;
    EXPECT_EQ(was.translation, is.translation) << i;
    EXPECT_TRUE(was.rotation.isApprox(is.rotation)) << i;
  }
  EXPECT_GT((before.vertices[0].world_from_vertex.translation -
             made.graph.vertices[0].world_from_vertex.translation)
                .norm(),
            1e-3);
  EXPECT_LT((made.graph.vertices[81].world_from_vertex.translation - edge.from_from_to.translation)
                .norm(),
            1e-6);
}

TEST(PoseGraph, AnEdgeThatKnowsDirectionsOnlyIsUsedForThose) {
  // Two fixed ends at x = 0 and x = 10; the pose between knows x from nobody but the first, y from
  // the second too.
  PoseGraph graph;
  graph.vertices = {
      {0, {}, true}, {1, {}, false}, {2, {Eigen::Quaterniond::Identity(), {10, 0, 0}}, true}};
  PoseGraphEdge first{
      0, 1, {Eigen::Quaterniond::Identity(), {4, 1, 0}}, Matrix6d::Identity(), true};
  first.information.bottomRightCorner<3, 3>() *= 1e6;
  PoseGraphEdge second{
      1, 2, {Eigen::Quaterniond::Identity(), {5, 0, 0}}, Matrix6d::Identity(), false};
  second.information(0, 0) = 0;
  graph.edges = {first, second};
  PoseGraphOptions options;
  options.objective = "information";

  OptimizePoseGraph(options, graph);

  const Rigid3& between = graph.vertices[1].world_from_vertex;
  EXPECT_NEAR(between.translation.x(), 4, 0.1);
  EXPECT_NEAR(between.translation.y(), 0.5, 0.1);
}

TEST(PoseGraph, AnIndefiniteMatrixIsRefusedByTheObjectiveThatUsesIt) {
  PoseGraph graph = MakeSyntheticGraph({.num_poses = 40}).graph;
  graph.edges[3].information(2, 3) = graph.edges[3].information(3, 2) = 1e6;
  PoseGraphOptions options;
  EXPECT_NO_THROW(OptimizePoseGraph(options, graph));
  options.objective = "information";
  EXPECT_THROW(OptimizePoseGraph(options, graph), Error);
}

TEST(PoseGraph, OptionsThatAreNoneAreRefused) {
  PoseGraph graph = MakeSyntheticGraph({.num_poses = 40}).graph;
  EXPECT_THROW(OptimizePoseGraph({.objective = "best"}, graph), Error);
  EXPECT_THROW(OptimizePoseGraph({.start = "random"}, graph), Error);
  EXPECT_THROW(OptimizePoseGraph({.max_iterations = -1}, graph), Error);
}

struct KnownOptimum {
  const char* name;
  double objective;
};

class SharedPoseGraph : public testing::TestWithParam<KnownOptimum> {};

TEST_P(SharedPoseGraph, ReachesTheCertifiedOptimumFromOdometryAlone) {
  const std::filesystem::path file = SharedGraph(std::string(GetParam().name) + ".g2o");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no pose graphs beside the repository";
  PoseGraph graph = ReadG2o(ReadFile(file));
  for (PoseGraphVertex& vertex : graph.vertices) vertex.world_from_vertex = {};

  const PoseGraphSummary summary = OptimizePoseGraph({}, graph);

  EXPECT_TRUE(summary.has_converged);
  // Known to four digits.
  EXPECT_NEAR(ObjectiveOf(graph, PoseGraphObjective::kChordal), GetParam().objective,
              1e-3 * GetParam().objective);
}

INSTANTIATE_TEST_SUITE_P(Known, SharedPoseGraph,
                         testing::Values(KnownOptimum{"parking-garage", 1.263},
                                         KnownOptimum{"sphere2500", 1687},
                                         KnownOptimum{"torus3D", 24227},
                                         KnownOptimum{"cubicle", 717.1}),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace parkade
