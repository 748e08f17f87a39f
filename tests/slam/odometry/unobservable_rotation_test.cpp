// What all cameras' rotations have in common is the IMU's as well: it is taken from the estimate
// only where that is sure, or refutes the rig.
#include <gtest/gtest.h>

#include "slam/odometry/gate_calibration.h"

namespace parkade {
namespace {

constexpr double kDegree = M_PI / 180;

/// Three cameras that look ahead, left and back.
Rig ThreeCameras() {
  Rig rig;
  rig.body_from_imu = {ExpSo3({0.02, -0.01, 0.03}), {0.2, 0.1, 0.4}};
  for (size_t i = 0; i < 3; ++i) {
    RigCamera& camera = rig.cameras.emplace_back();
    camera.body_from_camera = {ExpSo3({0, 0, 0.5 * M_PI * static_cast<double>(i)}),
                               {2.0 - static_cast<double>(i), 1, 1}};
  }
  return rig;
}

/// Each camera turned by `common` [rad, in imu], the second by `relative` as well.
std::vector<CameraParameters> Turned(const Rig& rig, const Eigen::Vector3d& common,
                                     const Eigen::Vector3d& relative) {
  std::vector<CameraParameters> cameras(rig.cameras.size());
  for (size_t i = 0; i < cameras.size(); ++i) {
    Rigid3 pose = rig.ImuFromCamera(i);
    pose.rotation = ExpSo3(i == 1 ? Eigen::Vector3d(common + relative) : common) * pose.rotation;
    PoseToParameters(pose, cameras[i].extrinsics.data());
  }
  return cameras;
}

/// A common error about z of the IMU of `common_sigma`, others of `sigma` [rad].
JointEstimate Joint(const std::vector<CameraParameters>& cameras, double common_sigma,
                    double sigma) {
  JointEstimate joint;
  const auto width = static_cast<Eigen::Index>(8 * cameras.size());
  Eigen::VectorXd common = Eigen::VectorXd::Zero(width);
  Eigen::Index column = 0;
  for (size_t i = 0; i < cameras.size(); ++i) {
    joint.states.push_back({{StateName::Kind::kExtrinsics, static_cast<std::int64_t>(i)}, {}});
    joint.states.push_back({{StateName::Kind::kTiming, static_cast<std::int64_t>(i)}, {}});
    common.segment<3>(column) =
        cameras[i].ImuFromCamera().rotation.conjugate() * Eigen::Vector3d(0, 0, common_sigma);
    column += 8;
  }
  joint.covariance =
      sigma * sigma * Eigen::MatrixXd::Identity(width, width) + common * common.transpose();
  joint.model_covariance = joint.covariance;
  return joint;
}

TEST(FindKeptTurn, KeepsWhatIsCommonAndUnsure) {
  const Rig rig = ThreeCameras();
  const auto estimate = Turned(rig, {0, 0, 0.3 * kDegree}, {0.4 * kDegree, 0, 0});
  const JointEstimate joint = Joint(estimate, 0.2 * kDegree, 0.01 * kDegree);

  const KeptTurn turn = FindKeptTurn(rig, estimate, joint);

  EXPECT_NEAR(turn.angle.z(), 0.3 * kDegree, 0.01 * kDegree);
  EXPECT_LT(turn.angle.head<2>().norm(), 0.01 * kDegree);
  const Rigid3 rest = rig.ImuFromCamera(0).Inverse() * turn.Without(estimate[0]).ImuFromCamera();
  EXPECT_LT(LogSo3(rest.rotation).norm(), 0.01 * kDegree);
  const Rigid3 own = rig.ImuFromCamera(1).Inverse() * turn.Without(estimate[1]).ImuFromCamera();
  EXPECT_NEAR(LogSo3(own.rotation).norm(), 0.4 * kDegree, 0.01 * kDegree);
  // What is left is as sure as each camera by itself.
  const CalibrationCovariance covariance = CovarianceWithout(turn, estimate, joint, 1);
  EXPECT_LT(std::sqrt(covariance.sandwich.topLeftCorner<3, 3>().trace()), 0.03 * kDegree);
}

TEST(FindKeptTurn, KeepsNothingThatIsSureOrRefutesTheRig) {
  const Rig rig = ThreeCameras();
  const auto estimate = Turned(rig, {0, 0, 0.3 * kDegree}, {0, 0, 0});

  EXPECT_LT(
      FindKeptTurn(rig, estimate, Joint(estimate, 0.03 * kDegree, 0.01 * kDegree)).angle.norm(),
      1e-9);
  EXPECT_LT(
      FindKeptTurn(rig, estimate, Joint(estimate, 0.08 * kDegree, 0.01 * kDegree)).angle.norm(),
      1e-9);
  JointEstimate held = Joint(estimate, 0.2 * kDegree, 0.01 * kDegree);
  held.states.erase(held.states.begin());  // the first camera's extrinsics are not estimated
  EXPECT_LT(FindKeptTurn(rig, estimate, held).angle.norm(), 1e-9);
}

TEST(RigOfEstimate, CamerasStayWhereTheEstimateSawThem) {
  const Rig rig = ThreeCameras();
  const auto estimate = Turned(rig, {0.1 * kDegree, 0, 0.3 * kDegree}, {0, 0, 0});
  const Rigid3 odom_from_imu{ExpSo3({0.1, 0.2, 1.3}), {3, 2, 1}};

  const Rig mounted = RigOfEstimate(rig, estimate);

  const Rigid3 odom_from_body = odom_from_imu * mounted.body_from_imu.Inverse();
  for (size_t i = 0; i < 3; ++i)
    EXPECT_LT((odom_from_body * rig.cameras[i].body_from_camera)
                  .rotation.angularDistance((odom_from_imu * estimate[i].ImuFromCamera()).rotation),
              1e-6)
        << i;
}

}  // namespace
}  // namespace parkade
