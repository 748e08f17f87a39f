#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>

#include "slam/imu_preintegration.h"
#include "slam/landmark_parameters.h"
#include "slam/start_motion.h"

namespace parkade {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kImageInterval = 0.08;  // [s] between images of one camera that are used
constexpr size_t kMinObservations = 3;
constexpr size_t kMinTracks = 15;
constexpr int kReweightings = 8;
constexpr double kRobustWidth = 3;          // [sigma] Cauchy
constexpr double kMaxTiltSigma = 0.10;      // [rad]
constexpr double kMaxVelocitySigma = 0.15;  // [m/s] plus a share of the speed
constexpr double kMaxVelocityShare = 0.10;
constexpr double kMaxMeanError = 4;   // [sigma] of the median ray after the fit
constexpr double kUnknownBias = 0.1;  // [m/s^2]

/// point seen along `direction` from velocity * t + gravity * t^2/2 + offset,
/// all in the IMU frame at the start.
struct Sight {
  double t = 0;
  Eigen::Vector3d direction;
  Eigen::Vector3d offset;
  double sigma = 1e-3;
  double weight = 1;  ///< of its distance [m] across the ray
};

struct TrackSights {
  std::vector<Sight> sights;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
};

std::vector<TrackSights> CollectSights(const ImuBuffer& imu, const std::vector<TrackedFrame>& frames, const Rig& rig,
                                       const ImuBias& bias, Timestamp begin, Timestamp end) {
  std::map<std::int64_t, TrackSights> tracks;
  std::vector<Timestamp> last_used(rig.cameras.size(), begin - 1.0);
  MotionIncrement increment;
  Timestamp at = begin;
  for (const TrackedFrame& frame : frames) {
    const auto camera = static_cast<size_t>(frame.camera);
    if (frame.time < begin || frame.time > end || frame.time - last_used[camera] < kImageInterval) continue;
    last_used[camera] = frame.time;
    if (frame.time > at) {
      const std::vector<ImuSample> samples = imu.Between(at, frame.time);
      for (size_t i = 1; i < samples.size(); ++i) Advance(increment, samples[i - 1], samples[i], bias);
      at = frame.time;
    }
    const Rigid3 imu_from_camera = rig.ImuFromCamera(camera);
    for (const FeatureObservation& seen : frame.observations)
      tracks[seen.track].sights.push_back(
          {frame.time - begin, increment.rotation * (imu_from_camera.rotation * seen.bearing),
           increment.position + increment.rotation * imu_from_camera.translation, seen.sigma, 1});
  }
  std::vector<TrackSights> kept;
  for (auto& [number, track] : tracks)
    if (track.sights.size() >= kMinObservations) kept.push_back(std::move(track));
  return kept;
}

struct LinearSystem {
  Matrix6d information = Matrix6d::Zero();  // of [velocity, gravity]
  Vector6d right = Vector6d::Zero();
};

struct TrackSystem {
  Eigen::Matrix3d points = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 6> cross = Eigen::Matrix<double, 3, 6>::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
};

TrackSystem Accumulate(const TrackSights& track, LinearSystem& system) {
  TrackSystem own;
  for (const Sight& sight : track.sights) {
    const Eigen::Matrix3d across =
        sight.weight * (Eigen::Matrix3d::Identity() - sight.direction * sight.direction.transpose());
    Eigen::Matrix<double, 3, 6> moved;
    moved << sight.t * Eigen::Matrix3d::Identity(), 0.5 * sight.t * sight.t * Eigen::Matrix3d::Identity();
    own.points += across;
    own.cross -= across * moved;
    own.right += across * sight.offset;
    system.information += moved.transpose() * across * moved;
    system.right -= moved.transpose() * across * sight.offset;
  }
  own.points += 1e-6 * own.points.trace() * Eigen::Matrix3d::Identity();
  const Eigen::Matrix<double, 6, 3> gain = own.cross.transpose() * own.points.inverse();
  system.information -= gain * own.cross;
  system.right -= gain * own.right;
  return own;
}

/// Minimises the quadratic subject to |gravity| = 9.81 by its Lagrange multiplier.
std::optional<Vector6d> SolveWithGravityNorm(const LinearSystem& system) {
  const Eigen::Matrix3d velocity_inverse =
      (system.information.topLeftCorner<3, 3>() + 1e-9 * Eigen::Matrix3d::Identity()).inverse();
  const Eigen::Matrix3d gain = system.information.bottomLeftCorner<3, 3>() * velocity_inverse;
  const Eigen::Matrix3d gravity_information =
      system.information.bottomRightCorner<3, 3>() - gain * system.information.topRightCorner<3, 3>();
  const Eigen::Vector3d gravity_right = system.right.tail<3>() - gain * system.right.head<3>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(gravity_information);
  const Eigen::Vector3d in_eigen = eigen.eigenvectors().transpose() * gravity_right;
  const double norm = kGravityInOdom.norm();
  const auto norm_at = [&](double multiplier) {
    return (in_eigen.array() / (eigen.eigenvalues().array() + multiplier)).matrix().norm();
  };
  // The norm falls monotonically right of the smallest pole.
  double low = -eigen.eigenvalues()[0] * (1 - 1e-9), high = gravity_right.norm() / norm + eigen.eigenvalues()[2];
  if (!(norm_at(low + 1e-12) > norm)) return std::nullopt;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (norm_at(middle) > norm ? low : high) = middle;
  }
  Vector6d solution;
  solution.tail<3>() = eigen.eigenvectors() * (in_eigen.array() / (eigen.eigenvalues().array() + high)).matrix();
  solution.head<3>() =
      velocity_inverse * (system.right.head<3>() - system.information.topRightCorner<3, 3>() * solution.tail<3>());
  if (!solution.allFinite()) return std::nullopt;
  return solution;
}

double AngularError(const Sight& sight, const Vector6d& solution, const Eigen::Vector3d& point, double& distance) {
  const Eigen::Vector3d offset =
      point - (sight.t * solution.head<3>() + 0.5 * sight.t * sight.t * solution.tail<3>() + sight.offset);
  distance = offset.norm();
  return std::atan2(sight.direction.cross(offset).norm(), sight.direction.dot(offset));
}

}  // namespace

std::optional<StartEstimate> StartFromImages(const ImuBuffer& imu, const std::vector<TrackedFrame>& frames,
                                             const Rig& rig, const GyroscopeBiasEstimate& bias, Timestamp begin,
                                             Timestamp end) {
  std::vector<TrackSights> tracks = CollectSights(imu, frames, rig, {bias.bias, Eigen::Vector3d::Zero()}, begin, end);
  if (tracks.size() < kMinTracks) return std::nullopt;
  LinearSystem system;
  Vector6d solution = Vector6d::Zero();
  std::vector<double> errors;
  for (int pass = 0; pass < kReweightings; ++pass) {
    system = {};
    std::vector<TrackSystem> systems;
    for (const TrackSights& track : tracks) systems.push_back(Accumulate(track, system));
    const std::optional<Vector6d> solved = SolveWithGravityNorm(system);
    if (!solved) return std::nullopt;
    solution = *solved;
    errors.clear();
    for (size_t i = 0; i < tracks.size(); ++i) {
      tracks[i].point = systems[i].points.ldlt().solve(systems[i].right - systems[i].cross * solution);
      for (Sight& sight : tracks[i].sights) {
        double distance = 1;
        const double error = AngularError(sight, solution, tracks[i].point, distance) / sight.sigma;
        errors.push_back(error);
        sight.weight =
            1 / (std::pow(std::max(distance, 0.1) * sight.sigma, 2) * (1 + std::pow(error / kRobustWidth, 2)));
      }
    }
  }
  std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2), errors.end());
  const double median_error = errors[errors.size() / 2];

  const Eigen::Vector3d down = solution.tail<3>().normalized();
  // Gravity moves on its sphere only.
  Eigen::Matrix<double, 6, 5> free = Eigen::Matrix<double, 6, 5>::Zero();
  free.topLeftCorner<3, 3>().setIdentity();
  free.bottomRightCorner<3, 2>() = kGravityInOdom.norm() * BasisAcross(down);
  const Eigen::Matrix<double, 5, 5> covariance =
      (free.transpose() * system.information * free + 1e-9 * Eigen::Matrix<double, 5, 5>::Identity()).inverse() *
      std::max(1.0, median_error * median_error);
  const auto largest = [](const auto& matrix) { return std::sqrt(matrix.eigenvalues().real().maxCoeff()); };
  const double velocity_sigma = largest(covariance.topLeftCorner<3, 3>().eval());
  const double tilt_sigma = largest(covariance.bottomRightCorner<2, 2>().eval());
  const double speed = solution.head<3>().norm();
  if (!(median_error < kMaxMeanError && tilt_sigma < kMaxTiltSigma &&
        velocity_sigma < kMaxVelocitySigma + kMaxVelocityShare * speed))
    return std::nullopt;

  StartEstimate start;
  start.kind = StartKind::kMovingInImages;
  start.state.time = begin;
  start.state.gyroscope_bias = bias.bias;
  start.state.odom_from_imu.rotation = LevelledRotation(solution.tail<3>());
  start.state.velocity_in_odom = start.state.odom_from_imu.rotation * solution.head<3>();
  start.uncertainty = {0.03 + 3 * tilt_sigma, 0.1 + 3 * velocity_sigma, std::max(3 * bias.sigma, 1e-3), kUnknownBias};
  return start;
}

}  // namespace parkade
