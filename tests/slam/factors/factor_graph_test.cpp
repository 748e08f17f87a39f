#include "slam/factors/factor_graph.h"

#include <gtest/gtest.h>

#include "slam/factors/imu_cost.h"
#include "slam/factors/measurement_model.h"
#include "slam/factors/relative_pose_cost.h"
#include "slam/factors/standstill_cost.h"
#include "slam/factors/wheel_cost.h"
#include "tests/support/synthetic_motion.h"

namespace parkade {
namespace {

constexpr double kInterval = 0.2;  // [s] between nodes
constexpr int kNumNodes = 3;

Timestamp TimeAt(double t) { return TimestampFromSeconds(100 + t); }

MotionState TruthAt(double t) {
  const BodyMotion motion = FlightMotion()(t);
  MotionState state;
  state.time = TimeAt(t);
  state.odom_from_imu = motion.world_from_body;
  state.velocity_in_odom = motion.velocity;
  return state;
}

ImuPreintegration ImuBetween(double begin, double end) {
  std::vector<ImuSample> samples;
  for (int k = 0; k <= 40; ++k) {
    const double t = begin + (end - begin) * k / 40;
    const BodyMotion motion = FlightMotion()(t);
    samples.push_back(
        {TimeAt(t), motion.angular_velocity,
         motion.world_from_body.rotation.conjugate() * (motion.acceleration - kGravityInOdom)});
  }
  return ImuPreintegration(std::move(samples), {}, {});
}

/// Three nodes of a flight, a camera and a point, with one measurement of each kind.
struct TinyWorld {
  ParameterArena arena{200};
  std::vector<NodeBlocks> nodes;
  double* wheel_scale = nullptr;
  double* site = nullptr;
  double* landmark = nullptr;
  CameraBlocks camera;
  std::vector<ImuPreintegration> imu;
  WheelPreintegration wheels;
  LinearPrior prior;
  AntennaFix fix;
  Rigid3 loop{ExpSo3({0.05, 0, 0.1}), {0.3, -0.2, 0.1}};
  Matrix6d loop_weight = 3 * Matrix6d::Identity();
  LandmarkRay ray{{0, 0, 1}, Eigen::Vector3d::UnitX()};
  ImageView view;
  std::unique_ptr<BearingCost> bearing;

  TinyWorld() {
    for (int i = 0; i < kNumNodes; ++i) {
      NodeBlocks& node = nodes.emplace_back();
      node.pose = arena.Add(std::array<double, kPoseSize>{});
      node.motion = arena.Add(std::array<double, kMotionSize>{});
      StateToParameters(TruthAt(kInterval * i), node.pose, node.motion);
      if (i > 0) imu.push_back(ImuBetween(kInterval * (i - 1), kInterval * i));
    }
    wheel_scale = arena.Add(std::array<double, 1>{0.01});
    camera.extrinsics = arena.Add(std::array<double, kPoseSize>{0, 0, 0, 1, 0.1, 0, 0});
    camera.timing = arena.Add(std::array<double, kTimingSize>{});
    site = arena.Add(std::array<double, kSiteSize>{0.1, 1, 2, 3});
    landmark = arena.Add(std::array<double, kLandmarkSize>{0.1, 0.2, 0.2});
    const std::vector<WheelSample> speeds{{TimeAt(0), 1, 0}, {TimeAt(kInterval), 1.2, 0}};
    wheels = PreintegrateWheels(imu[0].samples(), speeds, Eigen::Vector3d::Zero(), {}, {});
    prior.blocks = {{{StateName::Kind::kPose, 0}, {}}};
    std::copy_n(nodes[0].pose, kPoseSize, prior.blocks[0].at.begin());
    prior.sqrt_information = 1e3 * Eigen::MatrixXd::Identity(6, 6);
    prior.offset = Eigen::VectorXd::Constant(6, 0.5);
    view.first_pose = nodes[0].pose;
    view.second_pose = nodes[1].pose;
    view.interpolation.fraction = 0.4;
    view.extrinsics = camera.extrinsics;
    view.timing = camera.timing;
    view.Update();
    bearing = std::make_unique<BearingCost>(&view, &ray, Bearing(Eigen::Vector3d::UnitZ(), 0.05));
  }

  void AddStates(FactorGraph& graph) const {
    for (const NodeBlocks& node : nodes) {
      graph.AddPose(node.pose, true);
      graph.AddMotion(node.motion, true);
    }
  }
};

GraphSolverOptions ToTheEnd() {
  GraphSolverOptions options;
  options.max_iterations = 50;
  options.function_tolerance = 1e-12;
  return options;
}

/// Squared norm of a cost's residual.
double Squared(const ceres::CostFunction& cost, const std::vector<double*>& blocks) {
  Eigen::VectorXd residual(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(blocks.data(), residual.data(), nullptr));
  return residual.squaredNorm();
}

double Cauchy(double squared) {
  constexpr double kWidth = kRobustWidth * kRobustWidth;
  return kWidth * std::log1p(squared / kWidth);
}

TEST(FactorGraph, CostsWhatItsFactorsCostByHand) {
  TinyWorld world;
  const NodeBlocks &i = world.nodes[0], &j = world.nodes[1];
  FactorGraph graph(world.arena, 1.0 / 6);
  world.AddStates(graph);
  graph.AddWheelScale(world.wheel_scale, true);
  graph.AddCamera(world.camera, true, false);
  graph.AddSiteFromOdom(world.site, true);

  graph.AddPrior(world.prior, {i.pose});
  graph.AddImu(world.imu[0], i, j);
  graph.AddWheels(world.wheels, i, j, world.wheel_scale);
  graph.AddStandstill(i, j);
  graph.AddLoop(world.loop, world.loop_weight, i.pose, j.pose);
  graph.AddFix(world.fix, i.pose, j.pose, world.site);
  graph.AddLandmark(world.landmark);
  graph.AddBearing(*world.bearing, world.view, world.landmark);

  const double by_hand[] = {
      Squared(LinearPriorCost(&world.prior), {i.pose}),
      Squared(ImuCost(&world.imu[0]), {i.pose, i.motion, j.pose, j.motion}),
      Cauchy(Squared(WheelCost(world.wheels), {i.pose, i.motion, j.pose, world.wheel_scale})),
      Squared(StandstillCost(), {i.pose, j.pose, j.motion}),
      Cauchy(Squared(RelativePoseCost(world.loop, world.loop_weight), {i.pose, j.pose})),
      Cauchy(Squared(GnssCost(world.fix), {i.pose, j.pose, world.site})),
      Cauchy(Squared(*world.bearing, {i.pose, j.pose, world.camera.extrinsics, world.camera.timing,
                                      world.landmark})) /
          6};
  double sum = 0;
  for (const double cost : by_hand) sum += 0.5 * cost;
  EXPECT_NEAR(graph.Cost(), sum, 1e-9 * sum);
}

TEST(FactorGraph, TheImuAloneBringsDisturbedNodesBackToTheTruth) {
  TinyWorld world;
  world.prior.offset.setZero();
  FactorGraph graph(world.arena, 1);
  world.AddStates(graph);
  LinearPrior start = world.prior;
  start.blocks = {{{StateName::Kind::kMotion, 0}, {}}};
  std::copy_n(world.nodes[0].motion, kMotionSize, start.blocks[0].at.begin());
  start.sqrt_information = 1e3 * Eigen::MatrixXd::Identity(kMotionSize, kMotionSize);
  start.offset = Eigen::VectorXd::Zero(kMotionSize);
  graph.AddPrior(world.prior, {world.nodes[0].pose});
  graph.AddPrior(start, {world.nodes[0].motion});
  for (size_t k = 1; k < kNumNodes; ++k) {
    graph.AddImu(world.imu[k - 1], world.nodes[k - 1], world.nodes[k]);
    world.nodes[k].pose[4] += 0.3;
    world.nodes[k].motion[1] -= 0.5;
  }
  const double before = graph.Cost();

  const SolveSummary summary = graph.Solve(ToTheEnd());

  EXPECT_GT(before, 1e3);
  EXPECT_LT(summary.final_cost, 0.1);
  const MotionState last = StateFromParameters({}, world.nodes[2].pose, world.nodes[2].motion),
                    truth = TruthAt(2 * kInterval);
  EXPECT_LT((last.odom_from_imu.translation - truth.odom_from_imu.translation).norm(), 1e-3);
  EXPECT_LT((last.velocity_in_odom - truth.velocity_in_odom).norm(), 2e-3);
}

TEST(FactorGraph, AStateThatIsNotFreeStays) {
  TinyWorld world;
  FactorGraph graph(world.arena, 1);
  graph.AddPose(world.nodes[0].pose, false);
  graph.AddPose(world.nodes[1].pose, true);
  graph.AddPose(world.nodes[0].pose, true);  // changes nothing
  graph.AddLoop(world.loop, world.loop_weight, world.nodes[0].pose, world.nodes[1].pose);
  const std::vector<double> held(world.nodes[0].pose, world.nodes[0].pose + kPoseSize);

  graph.Solve(ToTheEnd());

  EXPECT_EQ(std::vector<double>(world.nodes[0].pose, world.nodes[0].pose + kPoseSize), held);
  const Rigid3 found =
      PoseFromParameters(world.nodes[0].pose).Inverse() * PoseFromParameters(world.nodes[1].pose);
  EXPECT_LT((found.translation - world.loop.translation).norm(), 1e-3);
}

TEST(FactorGraph, WithoutASolutionAllStatesStay) {
  TinyWorld world;
  FactorGraph graph(world.arena, 1);
  world.AddStates(graph);
  LinearPrior broken = world.prior;
  broken.offset[0] = std::numeric_limits<double>::quiet_NaN();
  graph.AddPrior(broken, {world.nodes[0].pose});
  const std::vector<double> before = world.arena.values();

  graph.Solve(ToTheEnd());

  EXPECT_EQ(world.arena.values(), before);
}

}  // namespace
}  // namespace parkade
