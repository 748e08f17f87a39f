#include "slam/schur/schur_solver.h"

#include <gtest/gtest.h>

#include <random>

#include "slam/refinement/adjusted_landmarks.h"
#include "slam/refinement/drive_graph.h"
#include "slam/refinement/drive_priors.h"
#include "tests/slam/worlds/noded_drive.h"

namespace parkade {
namespace {

using Solver = GraphSolverOptions::Solver;

/// A drive of 6 s with two cameras and a loop, all nodes but the first off by about a centimeter.
struct DisturbedDrive {
  NodedDrive noded{
      {.seed = 4, .duration = 6, .start = 12, .camera_rate = 10, .num_cameras = 2, .outliers = 0}};
  std::unique_ptr<DriveMeasurements> measurements = noded.Measure();

  std::unique_ptr<AdjustedDrive> Make() const {
    std::mt19937 random(9);
    std::normal_distribution<double> normal(0, 0.01);
    std::vector<MotionState> start;
    for (int node = 0; node < noded.num_nodes(); ++node) {
      start.push_back(noded.TruthAt(node));
      for (int axis = 0; axis < 3 && node > 0; ++axis)
        start.back().odom_from_imu.translation[axis] += normal(random);
    }
    const std::vector<ChosenTrack> tracks = ChooseTracks(*measurements, {});
    auto drive = std::make_unique<AdjustedDrive>(*measurements, start, tracks.size());
    AddDrivePriors(noded.rig(), *drive);
    AddLandmarks(*measurements, tracks, *drive);
    const Rigid3 first = noded.TruthAt(2).odom_from_imu, last = noded.TruthAt(25).odom_from_imu;
    drive->loops.push_back({2, 25, first.Inverse() * last, 100 * Matrix6d::Identity()});
    return drive;
  }
};

struct Solved {
  SolveSummary summary;
  double cost_before = 0;
  std::vector<double> values;
};

Solved SolveBy(Solver solver, const AdjustedStretch& stretch, int max_iterations) {
  static const DisturbedDrive disturbed;
  const std::unique_ptr<AdjustedDrive> drive = disturbed.Make();
  DriveGraph graph(*drive, stretch, 1.0 / 6);
  GraphSolverOptions options;
  options.solver = solver;
  options.max_iterations = max_iterations;
  options.function_tolerance = 1e-9;
  Solved solved{{}, graph.graph().Cost(), {}};
  solved.summary = graph.graph().Solve(options);
  solved.values = drive->arena.values();
  return solved;
}

/// [m, rad, m/s ...] the largest difference of two solutions.
double Difference(const Solved& a, const Solved& b) {
  EXPECT_EQ(a.values.size(), b.values.size());
  double largest = 0;
  for (size_t i = 0; i < a.values.size(); ++i)
    largest = std::max(largest, std::abs(a.values[i] - b.values[i]));
  return largest;
}

constexpr AdjustedStretch kWhole{0, 30, false, true};

TEST(SchurSolver, OneStepIsTheOneOfCeres) {
  const Solved by_ceres = SolveBy(Solver::kCeresSparse, kWhole, 1);
  const Solved own = SolveBy(Solver::kSchurSolver, kWhole, 1);

  EXPECT_EQ(own.summary.iterations, by_ceres.summary.iterations);
  EXPECT_LT(own.summary.final_cost, 0.9 * own.cost_before);
  EXPECT_NEAR(own.summary.final_cost, by_ceres.summary.final_cost,
              1e-6 * by_ceres.summary.final_cost);
  EXPECT_LT(Difference(own, by_ceres), 1e-6);
}

TEST(SchurSolver, EndsWhereCeresDoes) {
  const Solved by_ceres = SolveBy(Solver::kCeresSparse, kWhole, 30);
  const Solved own = SolveBy(Solver::kSchurSolver, kWhole, 30);

  EXPECT_GT(own.summary.iterations, 3);
  EXPECT_NEAR(own.summary.final_cost, by_ceres.summary.final_cost,
              1e-6 * by_ceres.summary.final_cost);
  EXPECT_LT(Difference(own, by_ceres), 1e-4);
}

TEST(SchurSolver, StatesOutsideAStretchStay) {
  const Solved by_ceres = SolveBy(Solver::kCeresSparse, {10, 20, false, false}, 5);
  const Solved own = SolveBy(Solver::kSchurSolver, {10, 20, false, false}, 5);

  EXPECT_LT(Difference(own, by_ceres), 1e-5);
}

TEST(SchurSolver, OneStepOfAWindowIsTheOneOfCeres) {
  const AdjustedStretch window{8, 20, true, false};
  const Solved by_ceres = SolveBy(Solver::kCeresDense, window, 1);
  const Solved own = SolveBy(Solver::kSchurSolver, window, 1);

  EXPECT_LT(own.summary.final_cost, 0.9 * own.cost_before);
  EXPECT_NEAR(own.summary.final_cost, by_ceres.summary.final_cost,
              1e-6 * by_ceres.summary.final_cost);
  EXPECT_LT(Difference(own, by_ceres), 1e-6);
}

TEST(SchurSolver, DenseAndSparseSystemsHaveTheSameSolution) {
  static const DisturbedDrive disturbed;
  const std::unique_ptr<AdjustedDrive> drive = disturbed.Make();
  DriveGraph graph(*drive, {8, 20, false, true}, 1);
  const SchurStructure structure(graph.graph().problem(), graph.graph().landmarks());
  graph.graph().Cost();
  LandmarkDamping damping{1e4, {structure.num_landmarks, Eigen::Vector3d::Zero()}};
  const std::unique_ptr<ReducedMatrix> dense = MakeDenseMatrix(structure),
                                       sparse = MakeSparseMatrix(structure);
  dense->SetZero();
  sparse->SetZero();
  for (size_t i = 0; i < structure.chunks.size(); ++i) {
    const SchurSums sums = SumUp(structure, structure.chunks[i], damping);
    dense->Add(i, sums);
    sparse->Add(i, sums);
  }

  const Eigen::VectorXd added = Eigen::VectorXd::Constant(structure.num_columns, 1e3),
                        right = Eigen::VectorXd::LinSpaced(structure.num_columns, -1, 1);
  const std::optional<Eigen::VectorXd> x = dense->Solve(added, right),
                                       expected = sparse->Solve(added, right);

  ASSERT_TRUE(x && expected);
  EXPECT_LT((*x - *expected).norm(), 1e-9 * expected->norm());
}

TEST(SchurSolver, CutsAProblemIntoChunksThatHoldEachFactorOnce) {
  static const DisturbedDrive disturbed;
  const std::unique_ptr<AdjustedDrive> drive = disturbed.Make();
  DriveGraph graph(*drive, kWhole, 1);

  const SchurStructure structure(graph.graph().problem(), graph.graph().landmarks());

  ASSERT_GT(structure.chunks.size(), 2u);
  EXPECT_EQ(structure.num_landmarks, graph.graph().landmarks().size());
  EXPECT_EQ(structure.factors.size(),
            static_cast<size_t>(graph.graph().problem().NumResidualBlocks()));
  std::uint32_t next_group = 0, num_factors = 0;
  for (const SchurChunk& chunk : structure.chunks) {
    EXPECT_EQ(chunk.first_group, next_group);
    next_group = chunk.end_group;
    for (std::uint32_t i = chunk.first_group; i < chunk.end_group; ++i)
      num_factors += structure.groups[i].end_factor - structure.groups[i].first_factor;
  }
  EXPECT_EQ(next_group, structure.groups.size());
  EXPECT_EQ(num_factors, structure.factors.size());
}

TEST(SchurSolver, DampsAsCeresDoes) {
  EXPECT_DOUBLE_EQ(ScaleOf(9), 0.25);
  EXPECT_DOUBLE_EQ(DampingOf(9, 0.25, 10), 0.9) << "a share of the diagonal";
  EXPECT_DOUBLE_EQ(DampingOf(0, 1, 10), 1e-7) << "bounded where nothing is seen";
}

}  // namespace
}  // namespace parkade
