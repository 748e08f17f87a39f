#include "slam/factors/imu_sensitivity.h"

namespace parkade {
namespace {

// Rig files say nothing about scale and misalignment, but noise tells the grade: an MEMS gyroscope
// of 2e-4 rad/s/sqrt(Hz) is off by some 1e-3, a fiber-optic one of 6e-5 by 3e-4; axes are askew by
// half of that.
constexpr double kScalePerNoise = 5;        // [sqrt(s)] of the gyroscope's noise density
constexpr double kMisalignmentShare = 0.5;  // of the scale's sigma

template <int kColumns>
using Block = Eigen::Matrix<double, 15, kColumns, Eigen::RowMajor>;

}  // namespace

Eigen::MatrixXd ScoreSensitivity(const ImuCost& cost, const ImuPreintegration& imu,
                                 const std::vector<const double*>& parameters) {
  Eigen::Matrix<double, 15, 1> residual;
  Block<kPoseSize> pose_i, pose_j;
  Block<kMotionSize> motion_i, motion_j;
  double* jacobians[] = {pose_i.data(), motion_i.data(), pose_j.data(), motion_j.data()};
  Eigen::MatrixXd score =
      Eigen::MatrixXd::Zero(2 * (kPoseTangentSize + kMotionSize), kImuSensitivities);
  if (!cost.Evaluate(parameters.data(), residual.data(), jacobians) || !(imu.duration() > 0))
    return score;
  // The first nine rows: the others hold the walk of the biases.
  Eigen::Matrix<double, 9, 2 * (kPoseTangentSize + kMotionSize)> all;
  all << pose_i.topLeftCorner<9, 6>(), motion_i.topRows<9>(), pose_j.topLeftCorner<9, 6>(),
      motion_j.topRows<9>();
  const MotionIncrement& increment = imu.increment();
  const Eigen::Vector3d rate = LogSo3(increment.rotation) / imu.duration(),
                        force = increment.velocity / imu.duration();
  const double scale = kScalePerNoise * imu.calibration().gyroscope_noise_density;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::VectorXd by_gyroscope = all.transpose() * motion_i.block<9, 1>(0, 3 + axis);
    const Eigen::VectorXd by_accelerometer = all.transpose() * motion_i.block<9, 1>(0, 6 + axis);
    for (int along = 0; along < 3; ++along) {
      const double sigma = axis == along ? scale : kMisalignmentShare * scale;
      score.col(3 * axis + along) = sigma * rate[along] * by_gyroscope;
      score.col(9 + 3 * axis + along) = sigma * force[along] * by_accelerometer;
    }
  }
  return score;
}

}  // namespace parkade
