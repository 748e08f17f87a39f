#include "mapping/observation/estimate_ground_plane.h"

#include <gtest/gtest.h>

#include "tests/mapping/worlds/synthetic_drive.h"

namespace parkade {
namespace {

/// Landmarks on the road (a third above it) along the first 30 m of the x axis.
std::vector<Landmark> MakeLandmarks(double sigma) {
  std::vector<Landmark> landmarks;
  for (int i = 0; i < 900; ++i) {
    const double x = -2 + 0.035 * i, y = 4 * std::sin(1.7 * i);
    const double z = i % 3 == 0 ? 0.5 + std::abs(std::sin(0.9 * i)) : 0.02 * std::sin(5.3 * i);
    landmarks.push_back({{}, 0, {x, y, z}, sigma, 4});
  }
  return landmarks;
}

/// A drive along x of a body that is mounted at any angle.
Trajectory MakeDrive(const Rigid3& ground_from_body, double swing) {
  std::vector<TrajectoryState> states(300);
  for (size_t i = 0; i < states.size(); ++i) {
    const auto step = static_cast<double>(i);
    states[i].time = TimestampFromSeconds(0.05 * step);
    const Rigid3 odom_from_ground{Eigen::Quaterniond(Eigen::AngleAxisd(swing * std::sin(0.2 * step),
                                                                       Eigen::Vector3d::UnitY())),
                                  {0.1 * step, 0, swing * std::cos(0.13 * step)}};
    states[i].world_from_body = odom_from_ground * ground_from_body;
  }
  return Trajectory(states);
}

class GroundPlane : public testing::Test {
 protected:
  GroundPlane() : rig_(MakeTestRig(/*has_vehicle=*/false)) {
    ground_from_body_.translation = {0, 0, 0.9};
    ground_from_body_.rotation =
        Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.4, -0.8, 0.4).normalized());
    for (RigCamera& camera : rig_.cameras)  // all 1.3 m above the road
      camera.body_from_camera.translation =
          ground_from_body_.Inverse() *
          Eigen::Vector3d(camera.body_from_camera.translation.x(), 0, 1.3);
  }
  Rig rig_;
  Rigid3 ground_from_body_;
};

TEST_F(GroundPlane, IsFoundUnderABodyMountedAtAnAngle) {
  const std::vector<Landmark> landmarks = MakeLandmarks(0.05);

  const auto body_from_ground =
      EstimateBodyFromGround(rig_, MakeDrive(ground_from_body_, 0), landmarks);

  ASSERT_TRUE(body_from_ground.has_value());
  const Rigid3 error = ground_from_body_ * *body_from_ground;
  EXPECT_NEAR(error.translation.z(), 0, 0.01);
  EXPECT_NEAR((error.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitZ()).norm(), 0,
              0.005);
  EXPECT_GT((error.rotation * Eigen::Vector3d::UnitX()).x(), 0.99)
      << "x points where the car drives";
}

TEST_F(GroundPlane, PitchIsFoundThoughEveryLandmarkIsPassedSideways) {
  std::vector<Landmark> landmarks = MakeLandmarks(0.05);
  std::erase_if(landmarks, [](const Landmark& landmark) {  // along the path of the body only
    return landmark.point_in_odom.x() < 1 || landmark.point_in_odom.x() > 26 ||
           std::abs(landmark.point_in_odom.y()) > 2;
  });

  const auto body_from_ground =
      EstimateBodyFromGround(rig_, MakeDrive(ground_from_body_, 0), landmarks);

  ASSERT_TRUE(body_from_ground.has_value());
  const Rigid3 error = ground_from_body_ * *body_from_ground;
  EXPECT_NEAR((error.rotation * Eigen::Vector3d::UnitZ()).x(), 0, 0.005);
}

TEST_F(GroundPlane, WithAVehicleItIsTheBodyItself) {
  const Rig rig = MakeTestRig();

  const auto body_from_ground = EstimateBodyFromGround(rig, MakeDrive(Rigid3{}, 0), {});

  ASSERT_TRUE(body_from_ground.has_value());
  EXPECT_EQ(body_from_ground->translation, Eigen::Vector3d::Zero());
}

TEST_F(GroundPlane, ABodyThatRollsLikeADroneHasNone) {
  const std::vector<Landmark> landmarks = MakeLandmarks(0.05);

  EXPECT_FALSE(
      EstimateBodyFromGround(rig_, MakeDrive(ground_from_body_, 0.6), landmarks).has_value());
}

TEST_F(GroundPlane, UncertainLandmarksAreNotBelieved) {
  const std::vector<Landmark> landmarks = MakeLandmarks(2.0);

  EXPECT_FALSE(
      EstimateBodyFromGround(rig_, MakeDrive(ground_from_body_, 0), landmarks).has_value());
}

TEST_F(GroundPlane, WithoutLandmarksOrPosesThereIsNone) {
  EXPECT_FALSE(EstimateBodyFromGround(rig_, MakeDrive(ground_from_body_, 0), {}).has_value());
  EXPECT_FALSE(EstimateBodyFromGround(rig_, Trajectory(), {}).has_value());
}

}  // namespace
}  // namespace parkade
