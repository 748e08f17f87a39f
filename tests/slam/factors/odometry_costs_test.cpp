// Jacobians of the smoother's cost functions against finite differences, and their values at the
// truth.
#include <gtest/gtest.h>

#include <random>

#include "slam/factors/bearing_cost.h"
#include "slam/factors/gnss_cost.h"
#include "slam/factors/imu_cost.h"
#include "slam/factors/linear_prior.h"
#include "slam/factors/standstill_cost.h"
#include "slam/factors/wheel_cost.h"
#include "tests/support/check_jacobian.h"
#include "tests/support/synthetic_motion.h"

namespace parkade {
namespace {

constexpr double kTolerance =
    2e-5;  // relative; finite differences of whitened residuals reach some 1e-6
const PoseManifold kPose;

struct NodeValues {
  std::vector<double> pose = std::vector<double>(kPoseSize),
                      motion = std::vector<double>(kMotionSize);
};

// A node near the true state of a flight.
NodeValues NodeAt(double time, std::uint32_t seed, double disturbance) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, disturbance);
  const auto vector = [&] {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Eigen::Vector3d(x, y, z);
  };
  const BodyMotion motion = FlightMotion()(time);
  NodeValues node;
  PoseToParameters({motion.world_from_body.rotation * ExpSo3(vector()),
                    motion.world_from_body.translation + vector()},
                   node.pose.data());
  Eigen::Map<Eigen::Matrix<double, 9, 1>>(node.motion.data()) << motion.velocity + vector(),
      vector(), vector();
  return node;
}

std::vector<ImuSample> ImuSamples(double begin, double end) {
  std::vector<ImuSample> samples;
  for (int k = 0; k <= 40; ++k) {
    const double t = begin + (end - begin) * k / 40;
    const BodyMotion motion = FlightMotion()(t);
    samples.push_back(
        {TimestampFromSeconds(100 + t), motion.angular_velocity,
         motion.world_from_body.rotation.conjugate() * (motion.acceleration - kGravityInOdom)});
  }
  return samples;
}

TEST(ImuCost, JacobiansAreRight) {
  const ImuPreintegration imu(ImuSamples(1, 1.2), {}, {});
  const ImuCost cost(&imu);
  const NodeValues i = NodeAt(1, 1, 0.02), j = NodeAt(1.2, 2, 0.02);
  std::vector<std::vector<double>> parameters{i.pose, i.motion, j.pose, j.motion};

  EXPECT_LT(JacobianError(cost, parameters, {&kPose, nullptr, &kPose, nullptr}), kTolerance);
}

TEST(ImuCost, IsZeroAtTheTruth) {
  const ImuPreintegration imu(ImuSamples(1, 1.2), {}, {});
  const NodeValues i = NodeAt(1, 1, 0), j = NodeAt(1.2, 2, 0);
  const double* parameters[] = {i.pose.data(), i.motion.data(), j.pose.data(), j.motion.data()};

  Eigen::Matrix<double, 15, 1> residual;
  ASSERT_TRUE(ImuCost(&imu).Evaluate(parameters, residual.data(), nullptr));

  EXPECT_LT(residual.norm(), 0.05);  // [sigma]
}

WheelPreintegration Wheels(double speed) {
  const std::vector<ImuSample> imu = ImuSamples(1, 1.2);
  const std::vector<WheelSample> wheels{{imu.front().time, speed, 0},
                                        {imu.back().time, speed + 0.3, 0}};
  const Rigid3 imu_from_body{ExpSo3({0.1, -0.05, 0.3}), {-1.1, 0.2, -0.5}};
  return PreintegrateWheels(imu, wheels, Eigen::Vector3d(0.01, 0, -0.02), imu_from_body,
                            WheelNoise{});
}

TEST(WheelCost, JacobiansAreRight) {
  const WheelCost cost(Wheels(4));
  const NodeValues i = NodeAt(1, 3, 0.05), j = NodeAt(1.2, 4, 0.05);
  std::vector<std::vector<double>> parameters{i.pose, i.motion, j.pose, {0.03}};

  EXPECT_LT(JacobianError(cost, parameters, {&kPose, nullptr, &kPose, nullptr}), kTolerance);
}

TEST(WheelCost, IsZeroForACarThatDrivesAsItsWheelsSay) {
  const MotionFunction motion = CarMotion(20);
  const Rigid3 imu_from_body = Rigid3{ExpSo3({0, 0.05, 0}), {1.2, 0.1, 0.5}}.Inverse();
  const double begin = 16;  // in a turn
  std::vector<ImuSample> imu;
  std::vector<WheelSample> wheels;
  for (int k = 0; k <= 20; ++k) {
    const BodyMotion at = motion(begin + 0.01 * k);
    const Timestamp time = TimestampFromSeconds(100 + 0.01 * k);
    imu.push_back({time, imu_from_body.rotation * at.angular_velocity, Eigen::Vector3d::Zero()});
    wheels.push_back({time, (at.world_from_body.rotation.conjugate() * at.velocity).x() / 1.02, 0});
  }
  const WheelCost cost(
      PreintegrateWheels(imu, wheels, Eigen::Vector3d::Zero(), imu_from_body, WheelNoise{}));
  NodeValues i, j;
  PoseToParameters(motion(begin).world_from_body * imu_from_body.Inverse(), i.pose.data());
  PoseToParameters(motion(begin + 0.2).world_from_body * imu_from_body.Inverse(), j.pose.data());
  const double scale = 0.02;
  const double* parameters[] = {i.pose.data(), i.motion.data(), j.pose.data(), &scale};

  Eigen::Vector3d residual;
  ASSERT_TRUE(cost.Evaluate(parameters, residual.data(), nullptr));

  EXPECT_LT(residual.norm(), 0.02);  // [sigma]
}

TEST(WheelPreintegration, BiasDerivativeAgreesWithIntegratingAgain) {
  const std::vector<ImuSample> imu = ImuSamples(1, 1.2);
  const std::vector<WheelSample> wheels{{imu.front().time, 3, 0}, {imu.back().time, 4, 0}};
  const Eigen::Vector3d bias(1e-3, -2e-3, 1.5e-3);
  const auto at = [&](const Eigen::Vector3d& b) {
    return PreintegrateWheels(imu, wheels, b, Rigid3{}, WheelNoise{});
  };

  const WheelPreintegration zero = at(Eigen::Vector3d::Zero());
  const Eigen::Vector3d predicted = zero.displacement + zero.d_gyroscope_bias * bias;

  EXPECT_LT((predicted - at(bias).displacement).norm(), 1e-6);
  EXPECT_GT((zero.displacement - at(bias).displacement).norm(), 1e-5);
}

TEST(GnssCost, JacobiansAreRight) {
  AntennaFix fix;
  fix.fraction = 0.3;
  fix.antenna_in_imu = {0.5, -0.2, 1.4};
  fix.antenna_in_site = {3, 4, 5};
  fix.sigma = {0.02, 0.03, 0.05};
  const GnssCost cost(fix);
  const NodeValues i = NodeAt(1, 1, 0.02), j = NodeAt(1.2, 2, 0.02);
  std::vector<std::vector<double>> parameters{i.pose, j.pose, {0.7, 10, -20, 3}};

  EXPECT_LT(JacobianError(cost, parameters, {&kPose, &kPose, nullptr}), kTolerance);
}

TEST(GnssCost, IsZeroWhereTheAntennaIsSaidToBe) {
  const NodeValues i = NodeAt(1, 1, 0.02);
  const Rigid3 site_from_odom{ExpSo3({0, 0, 0.7}), {10, -20, 3}};
  AntennaFix fix;
  fix.antenna_in_imu = {0.5, -0.2, 1.4};
  fix.antenna_in_site = site_from_odom * (PoseFromParameters(i.pose.data()) * fix.antenna_in_imu);
  const std::vector<double> site = {0.7, 10, -20, 3};
  const double* parameters[] = {i.pose.data(), i.pose.data(), site.data()};

  Eigen::Vector3d residual;
  ASSERT_TRUE(GnssCost(fix).Evaluate(parameters, residual.data(), nullptr));

  EXPECT_LT(residual.norm(), 1e-9);
}

TEST(StandstillCost, JacobiansAreRight) {
  const StandstillCost cost(StandstillNoise{});
  const NodeValues i = NodeAt(1, 3, 0.05), j = NodeAt(1, 4, 0.05);
  std::vector<std::vector<double>> parameters{i.pose, j.pose, j.motion};

  EXPECT_LT(JacobianError(cost, parameters, {&kPose, &kPose, nullptr}), kTolerance);
}

struct LandmarkObservation {
  std::vector<double> extrinsics = std::vector<double>(kPoseSize), timing{0.012, 4e-5};
  NodeValues first = NodeAt(1, 5, 0.02), second = NodeAt(1.2, 6, 0.02);
  LandmarkRay ray{{0.3, -0.1, 0.2}, {1, 2, -0.5}};
  ImageView view;

  LandmarkObservation() {
    PoseToParameters({ExpSo3({1.2, -1.1, 1.3}), {0.8, -0.3, 0.2}}, extrinsics.data());
    const std::vector<ImuSample> samples = ImuSamples(1, 1.2);
    view.interpolation =
        MakeNodeInterpolation(Integrate(std::span(samples).first(17), {}), Integrate(samples, {}),
                              PoseFromParameters(first.pose.data()).rotation);
    view.time_offset = 0.004;
    view.angular_velocity = {0.3, -0.5, 0.8};
    view.velocity_in_odom = {1.2, 4, -0.3};
  }

  /// Parameter blocks of a bearing; `view` points at them.
  std::vector<std::vector<double>> Blocks(bool is_between, const std::vector<double>& landmark) {
    std::vector<std::vector<double>> blocks{first.pose, second.pose, extrinsics, timing, landmark};
    if (!is_between) blocks.erase(blocks.begin() + 1);
    view.first_pose = blocks[0].data();
    view.second_pose = is_between ? blocks[1].data() : nullptr;
    view.extrinsics = blocks[blocks.size() - 3].data();
    view.timing = blocks[blocks.size() - 2].data();
    return blocks;
  }
};

TEST(BearingCost, JacobiansAreRightBetweenTwoNodes) {
  LandmarkObservation observation;
  std::vector<std::vector<double>> parameters = observation.Blocks(true, {0.05, -0.03, 0.2});
  for (const Eigen::Vector3d& measured :
       {Eigen::Vector3d(0.1, 0.2, 1), Eigen::Vector3d(1, 0.3, -0.3),
        Eigen::Vector3d(-0.2, -1, 0.1)}) {
    const BearingCost cost(&observation.view, &observation.ray,
                           Bearing(measured.normalized(), 1e-2, 150));

    EXPECT_LT(JacobianError(cost, parameters, {&kPose, &kPose, &kPose, nullptr, nullptr},
                            [&] { observation.view.Update(); }),
              kTolerance);
  }
}

TEST(BearingCost, JacobiansAreRightAtANodeAndAtInfinity) {
  LandmarkObservation observation;
  observation.view.interpolation = {};
  std::vector<std::vector<double>> parameters = observation.Blocks(false, {0.05, -0.03, 0.0});
  const BearingCost cost(&observation.view, &observation.ray,
                         Bearing(Eigen::Vector3d(0.1, 0.2, 1).normalized(), 1e-2, -99));

  EXPECT_LT(JacobianError(cost, parameters, {&kPose, &kPose, nullptr, nullptr},
                          [&] { observation.view.Update(); }),
            kTolerance);
}

TEST(BearingCost, IsTheAngleOverSigmaEvenBehindTheImagePlane) {
  LandmarkObservation observation;
  observation.view.interpolation = {};
  observation.timing = {observation.view.time_offset, 0};
  const std::vector<std::vector<double>> blocks = observation.Blocks(false, {0, 0, 0.25});
  observation.view.Update();
  const double* landmark = blocks.back().data();
  const Eigen::Vector3d direction =
      LandmarkInCamera(observation.view, observation.ray, landmark, 0).normalized();
  const Eigen::Vector3d point_in_camera =
      observation.view.OdomFromCamera(0).Inverse() * observation.ray.Point(landmark);
  EXPECT_LT((point_in_camera.normalized() - direction).norm(), 1e-9);

  const Eigen::Vector3d measured = ExpSo3(0.01 * BasisAcross(direction).col(0)) * direction;
  std::vector<const double*> parameters;
  for (const auto& block : blocks) parameters.push_back(block.data());
  Eigen::Vector2d residual;
  ASSERT_TRUE(BearingCost(&observation.view, &observation.ray, Bearing(measured, 2e-3))
                  .Evaluate(parameters.data(), residual.data(), nullptr));

  EXPECT_NEAR(residual.norm(), 5, 1e-3);
}

// The car moves on while rows are read: against the true motion instead of the first-order one.
TEST(BearingCost, LooksFromWhereTheCarWasWhenTheRowWasExposed) {
  const MotionFunction motion = FlightMotion();
  const double t = 1.1, line_delay = 3e-5, row = -200, offset = 0.003;
  const BodyMotion at = motion(t);
  std::vector<double> pose(kPoseSize), extrinsics(kPoseSize);
  PoseToParameters(at.world_from_body, pose.data());
  PoseToParameters({ExpSo3({1.2, -1.1, 1.3}), {0.8, -0.3, 0.2}}, extrinsics.data());
  double timing[] = {offset, line_delay};
  ImageView view;
  view.first_pose = pose.data();
  view.extrinsics = extrinsics.data();
  view.timing = timing;
  view.angular_velocity = at.angular_velocity;
  view.velocity_in_odom = at.velocity;
  view.Update();

  const Rigid3 expected =
      motion(t + offset + row * line_delay).world_from_body * PoseFromParameters(extrinsics.data());

  EXPECT_LT((view.OdomFromCamera(row).translation - expected.translation).norm(), 5e-5);
  EXPECT_LT(view.OdomFromCamera(row).rotation.angularDistance(expected.rotation), 5e-5);
  EXPECT_GT((at.world_from_body.translation -
             motion(t + offset + row * line_delay).world_from_body.translation)
                .norm(),
            1e-3);
}

TEST(LinearPriorCost, IsLinearAroundItsPointAndKeepsItsJacobian) {
  LinearPrior prior;
  prior.blocks = {{{StateName::Kind::kPose, 3}, {}},
                  {{StateName::Kind::kMotion, 3}, {}},
                  {{StateName::Kind::kWheelScale, 0}, {}},
                  {{StateName::Kind::kExtrinsics, 1}, {}},
                  {{StateName::Kind::kTiming, 1}, {}}};
  const NodeValues at = NodeAt(1, 8, 0.1);
  std::copy(at.pose.begin(), at.pose.end(), prior.blocks[0].at.begin());
  std::copy(at.motion.begin(), at.motion.end(), prior.blocks[1].at.begin());
  std::copy(at.pose.begin(), at.pose.end(), prior.blocks[3].at.begin());
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  prior.sqrt_information = Eigen::MatrixXd::NullaryExpr(24, 24, [&] { return normal(random); });
  prior.offset = Eigen::VectorXd::NullaryExpr(24, [&] { return normal(random); });
  const LinearPriorCost cost(&prior);
  std::vector<std::vector<double>> parameters{at.pose, at.motion, {0.0}, at.pose, {0.01, 1e-5}};

  EXPECT_EQ(prior.Columns(), 24);
  EXPECT_LT(JacobianError(cost, parameters, {&kPose, nullptr, nullptr, &kPose, nullptr}),
            kTolerance);
}

}  // namespace
}  // namespace parkade
