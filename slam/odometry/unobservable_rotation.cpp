// FindKeptTurn: the rotation that the estimates of all cameras have in common.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "slam/odometry/gate_calibration.h"

namespace parkade {
namespace {

constexpr double kSureTurn =
    0.075 * M_PI / 180;  // [rad] sigma of a common rotation that is taken, however large it is
constexpr double kRefuted = 3;  // [sigma] by which a less sure rotation must differ from none

/// First column of the camera's state in `joint`; -1 where it is not estimated.
Eigen::Index ColumnOf(const JointEstimate& joint, StateName::Kind kind, size_t camera) {
  Eigen::Index column = 0;
  for (const PriorBlock& block : joint.states) {
    if (block.name == StateName{kind, static_cast<std::int64_t>(camera)}) return column;
    column += block.TangentSize();
  }
  return -1;
}

Eigen::Matrix3d RotationOf(const CameraParameters& camera) {
  return camera.ImuFromCamera().rotation.toRotationMatrix();
}

/// The rotation of each camera's estimate against the rig [rad, in imu].
Eigen::Vector3d TurnOf(const Rigid3& imu_from_camera, const CameraParameters& estimate) {
  return LogSo3(
      (estimate.ImuFromCamera().rotation * imu_from_camera.rotation.conjugate()).normalized());
}

/// d mean turn / d states of `joint`.
Eigen::MatrixXd MeanOfTurns(const std::vector<double>& weights,
                            const std::vector<CameraParameters>& estimate,
                            const JointEstimate& joint) {
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(3, joint.covariance.cols());
  for (size_t i = 0; i < weights.size(); ++i)
    mean.middleCols<3>(ColumnOf(joint, StateName::Kind::kExtrinsics, i)) =
        weights[i] * RotationOf(estimate[i]);
  return mean;
}

}  // namespace

CameraParameters KeptTurn::Without(const CameraParameters& estimate) const {
  CameraParameters rest = estimate;
  const Rigid3 imu_from_camera = estimate.ImuFromCamera();
  PoseToParameters(
      {(ExpSo3(-angle) * imu_from_camera.rotation).normalized(), imu_from_camera.translation},
      rest.extrinsics.data());
  return rest;
}

KeptTurn FindKeptTurn(const Rig& rig, const std::vector<CameraParameters>& estimate,
                      const JointEstimate& joint) {
  KeptTurn kept;
  if (joint.covariance.size() == 0) return kept;
  std::vector<double> weights;
  double sum = 0;
  for (size_t i = 0; i < estimate.size(); ++i) {
    const Eigen::Index column = ColumnOf(joint, StateName::Kind::kExtrinsics, i);
    if (column < 0) return kept;
    const double variance = joint.covariance.block<3, 3>(column, column).trace();
    weights.push_back(1 / (variance * variance));  // one that saw nothing has no say
    sum += weights.back();
  }
  if (!(std::isfinite(sum) && sum > 0)) return kept;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < weights.size(); ++i) {
    weights[i] /= sum;
    turn += weights[i] * TurnOf(rig.ImuFromCamera(i), estimate[i]);
  }
  kept.weights = weights;
  const Eigen::MatrixXd mean = MeanOfTurns(weights, estimate, joint);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(mean * joint.covariance *
                                                             mean.transpose());
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d direction = eigen.eigenvectors().col(k);
    const double sigma = std::sqrt(std::max(0.0, eigen.eigenvalues()[k]));
    if (sigma > kSureTurn && std::abs(direction.dot(turn)) < kRefuted * sigma)
      kept.directions += direction * direction.transpose();
  }
  kept.angle = kept.directions * turn;
  return kept;
}

CalibrationCovariance CovarianceWithout(const KeptTurn& turn,
                                        const std::vector<CameraParameters>& estimate,
                                        const JointEstimate& joint, size_t camera) {
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(8, joint.covariance.cols());
  const Eigen::Index extrinsics = ColumnOf(joint, StateName::Kind::kExtrinsics, camera);
  const Eigen::Index timing = ColumnOf(joint, StateName::Kind::kTiming, camera);
  if (extrinsics >= 0) own.block<6, 6>(0, extrinsics).setIdentity();
  if (timing >= 0) own.block<2, 2>(6, timing).setIdentity();
  if (!turn.weights.empty())
    own.topRows<3>() -= RotationOf(estimate[camera]).transpose() * turn.directions *
                        MeanOfTurns(turn.weights, estimate, joint);
  return {own * joint.model_covariance * own.transpose(), own * joint.covariance * own.transpose()};
}

Rig RigOfEstimate(const Rig& reported, const std::vector<CameraParameters>& estimate) {
  Rig rig = reported;
  std::array<std::vector<double>, 3> turns;  // by axis
  for (size_t i = 0; i < estimate.size(); ++i) {
    const Eigen::Vector3d turn = TurnOf(reported.ImuFromCamera(i), estimate[i]);
    for (size_t axis = 0; axis < 3; ++axis)
      turns[axis].push_back(turn[static_cast<Eigen::Index>(axis)]);
  }
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  for (size_t axis = 0; axis < 3 && !estimate.empty(); ++axis) {
    std::sort(turns[axis].begin(), turns[axis].end());
    turn[static_cast<Eigen::Index>(axis)] =
        0.5 * (turns[axis][(estimate.size() - 1) / 2] + turns[axis][estimate.size() / 2]);
  }
  rig.body_from_imu.rotation = (rig.body_from_imu.rotation * ExpSo3(-turn)).normalized();
  return rig;
}

}  // namespace parkade
