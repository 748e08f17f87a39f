#include "slam/refinement/drive_priors.h"

#include <algorithm>

#include "slam/factors/measurement_model.h"

namespace parkade {
namespace {

using Kind = StateName::Kind;

constexpr double kHeld = 1e-6;                   // sigma of what must not move
constexpr double kFirstVelocity = 30;            // [m/s] before the drive tells
constexpr double kFirstGyroscopeBias = 0.02;     // [rad/s] before the drive tells
constexpr double kFirstAccelerometerBias = 0.3;  // [m/s^2] before the drive tells

LinearPrior PriorOf(const StateName& name, const double* at,
                    const Eigen::MatrixXd& sqrt_information) {
  LinearPrior prior;
  prior.blocks.push_back({name, {}});
  std::copy_n(at, name.Size(), prior.blocks.back().at.begin());
  prior.sqrt_information = sqrt_information;
  prior.offset = Eigen::VectorXd::Zero(sqrt_information.rows());
  return prior;
}

/// Cameras of one stereo head keep their angles: odometry knows those better than a batch without
/// its ties.
void HoldHeads(const Rig& rig, AdjustedDrive& drive) {
  for (size_t i = 0; i < rig.cameras.size(); ++i)
    for (size_t j = 0; j < rig.cameras.size(); ++j)
      if (i != j &&
          (rig.ImuFromCamera(i).translation - rig.ImuFromCamera(j).translation).norm() < kHeadSize)
        drive.camera_priors[i].rotation = drive.camera_priors[i].translation = 0;
}

void AddPriorsOfStart(AdjustedDrive& drive) {
  // Nothing measures where the drive begins and which way it heads; roll and pitch are gravity's.
  const AdjustedNode& first = drive.nodes.front();
  const Rigid3 odom_from_imu = PoseFromParameters(first.pose);
  Eigen::MatrixXd pose = Eigen::MatrixXd::Zero(4, kPoseTangentSize);
  pose.row(0).head<3>() =
      (odom_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ()).transpose() / kHeld;
  pose.bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity() / kHeld;
  drive.priors.push_back(PriorOf({Kind::kPose, 0}, first.pose, pose));
  const std::array<double, kMotionSize> nothing{};
  Eigen::VectorXd sigmas(kMotionSize);
  sigmas << Eigen::Vector3d::Constant(kFirstVelocity),
      Eigen::Vector3d::Constant(kFirstGyroscopeBias),
      Eigen::Vector3d::Constant(kFirstAccelerometerBias);
  drive.priors.push_back(
      PriorOf({Kind::kMotion, 0}, nothing.data(), sigmas.cwiseInverse().asDiagonal()));
  const double no_error = 0;
  drive.priors.push_back(PriorOf({Kind::kWheelScale, 0}, &no_error,
                                 Eigen::MatrixXd::Constant(1, 1, 1 / kWheelScaleSigma)));
}

void AddPriorsOfCameras(const Rig& rig, AdjustedDrive& drive) {
  for (size_t i = 0; i < drive.cameras.size(); ++i) {
    const CameraSigmas& sigma = drive.camera_priors[i];
    const auto number = static_cast<std::int64_t>(i);
    CameraParameters by_rig;
    PoseToParameters(rig.ImuFromCamera(i), by_rig.extrinsics.data());
    by_rig.timing = {0, rig.cameras[i].line_delay};
    if (sigma.rotation > 0) {
      Eigen::VectorXd extrinsics(kPoseTangentSize);
      extrinsics << Eigen::Vector3d::Constant(sigma.rotation),
          Eigen::Vector3d::Constant(sigma.translation);
      drive.priors.push_back(PriorOf({Kind::kExtrinsics, number}, by_rig.extrinsics.data(),
                                     extrinsics.cwiseInverse().asDiagonal()));
    }
    if (sigma.time_offset > 0 || sigma.line_delay > 0) {
      const Eigen::Vector2d timing(sigma.time_offset > 0 ? sigma.time_offset : 1,
                                   sigma.line_delay > 0 ? sigma.line_delay : 1);
      drive.priors.push_back(PriorOf({Kind::kTiming, number}, by_rig.timing.data(),
                                     timing.cwiseInverse().asDiagonal()));
    }
  }
}

}  // namespace

void AddDrivePriors(const Rig& rig, AdjustedDrive& drive) {
  HoldHeads(rig, drive);
  AddPriorsOfStart(drive);
  AddPriorsOfCameras(rig, drive);
}

}  // namespace parkade
