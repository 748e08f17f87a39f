#include "slam/initialization/start_linearization.h"

#include "slam/factors/landmark_parameters.h"

namespace parkade {
namespace {

Eigen::Matrix3d RotationOf(const StartImage& image, const ImuBias& bias,
                           const ImuBias& linearized_at) {
  return image.rotation *
         ExpSo3(image.rotation_by_gyroscope * (bias.gyroscope - linearized_at.gyroscope))
             .toRotationMatrix();
}

}  // namespace

Eigen::Matrix<double, 3, 2> GravityBasis(const Eigen::Vector3d& gravity) {
  return gravity.norm() * BasisAcross(gravity.normalized());
}

PlacedStartImage PlaceStartImage(const StartImage& image, const StartMotion& motion,
                                 const ImuBias& linearized_at) {
  PlacedStartImage at;
  at.rotation = RotationOf(image, motion.bias, linearized_at);
  at.center = CenterOf(image, motion, linearized_at);
  at.turn_by_motion.setZero();
  at.turn_by_motion.middleCols<3>(5) = image.rotation_by_gyroscope;
  at.center_by_motion.leftCols<3>() = image.t * Eigen::Matrix3d::Identity();
  at.center_by_motion.middleCols<2>(3) = 0.5 * image.t * image.t * GravityBasis(motion.gravity);
  at.center_by_motion.middleCols<3>(5) =
      image.position_by_gyroscope -
      at.rotation * Skew(image.camera_in_imu) * image.rotation_by_gyroscope;
  at.center_by_motion.rightCols<3>() = image.position_by_accelerometer;
  return at;
}

StartResidual LinearizeStart(const StartTrack& track, const Eigen::Matrix<double, 3, 2>& across,
                             const StartObservation& observation, const PlacedStartImage& at,
                             double noise, bool wants_motion) {
  StartResidual result;
  const double sigma = observation.sigma * noise;
  const Eigen::Vector3d offset = track.origin - at.center;
  const Eigen::Vector3d seen =
      at.rotation.transpose() * (track.ray + track.inverse_distance * offset);
  const double length = seen.norm();
  if (!(seen.dot(observation.bearing) > 1e-6)) {
    result.residual.x() = 1 / sigma;
    return result;
  }
  const Eigen::Matrix<double, 3, 2> basis = BasisAcross(observation.bearing);
  const Eigen::Vector3d direction = seen / length;
  result.residual = basis.transpose() * direction / sigma;
  const Eigen::Matrix<double, 2, 3> by_seen =
      basis.transpose() * (Eigen::Matrix3d::Identity() - direction * direction.transpose()) /
      (length * sigma);
  const Eigen::Matrix<double, 2, 3> by_ray = by_seen * at.rotation.transpose();
  result.by_point.leftCols<2>() = by_ray * across;
  result.by_point.col(2) = by_ray * offset;
  if (wants_motion)
    result.by_motion = by_seen * Skew(seen) * at.turn_by_motion -
                       track.inverse_distance * by_ray * at.center_by_motion;
  return result;
}

Eigen::Vector3d CenterOf(const StartImage& image, const StartMotion& motion,
                         const ImuBias& linearized_at) {
  return motion.velocity * image.t + 0.5 * image.t * image.t * motion.gravity + image.position +
         image.position_by_gyroscope * (motion.bias.gyroscope - linearized_at.gyroscope) +
         image.position_by_accelerometer *
             (motion.bias.accelerometer - linearized_at.accelerometer) +
         RotationOf(image, motion.bias, linearized_at) * image.camera_in_imu;
}

}  // namespace parkade
