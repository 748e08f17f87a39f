#include "slam/pose_graph/robust_pose_graph.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "core/error.h"
#include "core/files/file.h"
#include "slam/pose_graph/g2o_file.h"
#include "slam/pose_graph/loop_support.h"
#include "tests/slam/worlds/synthetic_pose_graph.h"

namespace parkade {
namespace {

TEST(RobustPoseGraph, WithoutWrongLoopsItIsThePlainSolution) {
  SyntheticGraph made = MakeSyntheticGraph({});
  PoseGraph plain = made.graph;
  OptimizePoseGraph({}, plain);

  const RobustPoseGraphSummary summary = OptimizePoseGraphRobustly({}, made.graph);

  const auto num_kept = std::count(summary.weights.begin(), summary.weights.end(), 1.0);
  EXPECT_GE(static_cast<double>(num_kept), 0.98 * static_cast<double>(summary.weights.size()));
  EXPECT_NEAR(PositionError(made.truth, made.graph), PositionError(made.truth, plain),
              0.05 * PositionError(made.truth, plain));
}

TEST(RobustPoseGraph, WrongLoopsDoNotMoveTheDrive) {
  for (const bool is_planar : {false, true}) {
    for (const double share : {0.1, 0.2, 0.3, 0.4, 0.5}) {
      for (const std::uint32_t seed : {1u, 2u, 3u}) {
        SyntheticGraph clean = MakeSyntheticGraph({.is_planar = is_planar, .seed = seed});
        OptimizePoseGraph({}, clean.graph);
        SyntheticGraph made =
            MakeSyntheticGraph({.wrong_share = share, .is_planar = is_planar, .seed = seed});
        ASSERT_GT(made.num_wrong_loops, 10u);

        const RobustPoseGraphSummary summary = OptimizePoseGraphRobustly({}, made.graph);

        const double error = PositionError(made.truth, made.graph),
                     expected = PositionError(clean.truth, clean.graph);
        EXPECT_LT(error, 1.05 * expected)
            << "share " << share << " seed " << seed << " planar " << is_planar;
        const auto first_wrong =
            summary.weights.end() - static_cast<std::ptrdiff_t>(made.num_wrong_loops);
        EXPECT_EQ(std::count(first_wrong, summary.weights.end(), 1.0), 0)
            << "wrong loops that survived";
      }
    }
  }
}

TEST(RobustPoseGraph, StretchesThatLookAlikeDoNotMoveTheDrive) {
  for (const double share : {0.1, 0.3}) {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
      SyntheticGraph clean = MakeSyntheticGraph({.seed = seed}), made = clean;
      OptimizePoseGraph({}, clean.graph);
      const size_t num_before = made.graph.edges.size();
      AddAlikeStretches(made.truth, share, 5, seed, made.graph);

      const RobustPoseGraphSummary summary = OptimizePoseGraphRobustly({}, made.graph);

      EXPECT_LT(PositionError(made.truth, made.graph),
                1.1 * PositionError(clean.truth, clean.graph))
          << "share " << share << " seed " << seed;
      const auto first_wrong = summary.weights.begin() + static_cast<std::ptrdiff_t>(num_before);
      EXPECT_EQ(std::count(first_wrong, summary.weights.end(), 1.0), 0)
          << "wrong loops that survived";
    }
  }
}

TEST(RobustPoseGraph, ASingleTrueLoopWithoutAPartnerIsFound) {
  SyntheticGraph made = MakeSyntheticGraph({});
  std::vector<PoseGraphEdge>& edges = made.graph.edges;
  edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(made.truth.size()), edges.end());
  ASSERT_FALSE(edges.back().is_trusted);
  const std::vector<bool> is_supported = FindSupportedLoops(made.graph);
  EXPECT_EQ(std::count(is_supported.begin(), is_supported.end(), true), 0);

  EXPECT_EQ(OptimizePoseGraphRobustly({}, made.graph).weights.back(), 1);
}

TEST(LoopSupport, RightLoopsHavePartnersAndWrongOnesHardlyEver) {
  const SyntheticGraph made = MakeSyntheticGraph({.wrong_share = 0.5});

  const std::vector<bool> is_supported = FindSupportedLoops(made.graph);

  const auto begin = is_supported.begin() + static_cast<std::ptrdiff_t>(made.truth.size() - 1);
  const auto wrong = begin + static_cast<std::ptrdiff_t>(made.num_right_loops);
  EXPECT_EQ(std::count(is_supported.begin(), begin, true), 0) << "odometry needs no support";
  EXPECT_GE(std::count(begin, wrong, true), static_cast<std::ptrdiff_t>(0.95 * 100));
  EXPECT_LE(std::count(wrong, is_supported.end(), true), 5);
}

TEST(RobustPoseGraph, RefusesAContinuationThatStandsStill) {
  PoseGraph graph = MakeSyntheticGraph({.num_poses = 40}).graph;
  RobustPoseGraphOptions options;
  options.mu_step = 1;
  EXPECT_THROW(OptimizePoseGraphRobustly(options, graph), Error);
}

class SharedRobustPoseGraph : public testing::TestWithParam<const char*> {};

TEST_P(SharedRobustPoseGraph, FortyPercentWrongLoopsChangeNothing) {
  const char* shared = std::getenv("PARKADE_SHARED_DATA");
  const auto file = std::filesystem::path(shared ? shared : "../shared/data") / "g2o" /
                    (GetParam() + std::string(".g2o"));
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no pose graphs beside the repository";
  PoseGraph clean = ReadG2o(ReadFile(file)), odometry = clean;
  OptimizePoseGraph({}, clean);
  const std::vector<Rigid3> reference = PosesOf(clean);
  OptimizePoseGraph({.start = "odometry", .max_iterations = 0}, odometry);
  PoseGraph graph = odometry;
  AddWrongLoops(reference, 0.4, 5, graph);

  OptimizePoseGraphRobustly({}, graph);

  EXPECT_LT(PositionError(reference, graph), 0.05 * PositionError(reference, odometry))
      << "distance to the clean optimum, in terms of the odometry's";
}

INSTANTIATE_TEST_SUITE_P(Known, SharedRobustPoseGraph, testing::Values("sphere2500"));

}  // namespace
}  // namespace parkade
