#include "server/ingest/checks/gyroscope_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/rigid3.h"
#include "server/ingest/checks/pair_motion.h"

namespace parkade {
namespace {

// What is fitted: true_from_read less the identity, row by row; a constant rate [rad/s]; the
// IMU's delay [s]; the way to the side per yaw angle [m].
constexpr Eigen::Index kConstantRate = 9, kDelayOf = 12, kSideways = 13, kNumUnknowns = 14;
using Unknowns = Eigen::Matrix<double, kNumUnknowns, 1>;
using Information = Eigen::Matrix<double, kNumUnknowns, kNumUnknowns>;

constexpr double kMinSpeed = 0.4;  // [m/s] of the wheels
constexpr double kMinSine = 0.1;   // of a point's angle to the way; at the way it tells nothing
constexpr int kMinPairs = 10;
constexpr double kNearPlane = 0.02;    // [rad] of a point from its epipolar plane
constexpr double kPointSigma = 0.005;  // [rad] of a point's distance from its plane

/// How far points of one pair lie from their epipolar planes, and what would change that.
struct PairEquations {
  std::vector<double> residuals;  ///< [rad]
  std::vector<Unknowns> jacobians;
  std::vector<double> by_speed;  ///< [rad] per share of the pair's speed, where it is not sure
  double turned = 0;             ///< [rad] by the gyroscope
};

/// What the IMU and the wheels say of the time between two images.
struct PairReadings {
  Eigen::Quaterniond turn;      ///< first_from_second of the IMU
  Eigen::Vector3d rate_change;  ///< [rad/s] in imu, from the first image to the second
  double way = 0;               ///< [m]
};

PairEquations EquationsOf(const ImagePair& pair, const RigCamera& camera, const Rig& rig,
                          const PairReadings& readings) {
  const Eigen::Quaterniond body_turn =
      rig.body_from_imu.rotation * readings.turn * rig.body_from_imu.rotation.conjugate();
  const Eigen::Quaterniond camera_from_body = camera.body_from_camera.rotation.conjugate();
  const Eigen::Vector3d way = WayOfCamera(camera, body_turn, readings.way);
  const Eigen::Vector3d way_per_sideways = camera_from_body * Eigen::Vector3d::UnitY() *
                                           (LogSo3(body_turn).z() / std::abs(readings.way));
  const Eigen::Quaterniond first_from_second =
      camera_from_body * body_turn * camera_from_body.conjugate();
  const Eigen::Matrix3d imu_from_camera =
      (camera_from_body * rig.body_from_imu.rotation).conjugate().toRotationMatrix();
  const Eigen::Vector3d read = LogSo3(readings.turn);
  PairEquations equations;
  equations.turned = read.norm();
  equations.residuals.reserve(pair.from.size());
  equations.jacobians.reserve(pair.from.size());
  constexpr double kShare = 0.01;
  const Eigen::Vector3d way_per_speed =
      (WayOfCamera(camera, body_turn, (1 + kShare) * readings.way) - way) / kShare;
  for (std::size_t i = 0; i < pair.from.size(); ++i) {
    const auto before = camera.model.Unproject(pair.from[i]),
               after = camera.model.Unproject(pair.to[i]);
    if (!before || !after) continue;
    const Eigen::Vector3d was = before->normalized();
    const Eigen::Vector3d now = first_from_second * after->normalized();
    const Eigen::Vector3d normal = was.cross(way);
    if (normal.norm() < kMinSine) continue;
    // A further small turn t of the camera moves `now` by t x now.
    const Eigen::Vector3d by_turn = imu_from_camera * now.cross(normal.normalized());
    equations.residuals.push_back(normal.normalized().dot(now));
    Unknowns jacobian;
    for (Eigen::Index row = 0; row < 3; ++row) jacobian.segment<3>(3 * row) = by_turn[row] * read;
    jacobian.segment<3>(kConstantRate) = (pair.second - pair.first) * by_turn;
    jacobian[kDelayOf] = by_turn.dot(readings.rate_change);
    jacobian[kSideways] = was.cross(way_per_sideways).dot(now) / normal.norm();
    equations.jacobians.push_back(jacobian);
    equations.by_speed.push_back(was.cross(way_per_speed).dot(now) / normal.norm());
  }
  return equations;
}

/// What readings are corrected by before they are fitted.
struct Correction {
  double gain = 1, delay = 0;  ///< [s] by which stamps are late
};

std::vector<PairEquations> AllEquations(const Rig& rig, const std::vector<const ImagePairs*>& pairs,
                                        const GyroscopeHistory& gyroscope,
                                        const SpeedHistory& wheels, const Correction& correction) {
  std::vector<PairEquations> all;
  for (std::size_t camera = 0; camera < pairs.size(); ++camera) {
    if (!pairs[camera]) continue;
    std::size_t wheel_hint = 0, rate_hint = 0;
    for (const ImagePair& pair : pairs[camera]->pairs()) {
      const std::optional<WheelSample> wheel = wheels.Near(pair.first, wheel_hint);
      const Timestamp first = pair.first + correction.delay,
                      second = pair.second + correction.delay;
      const auto turn = gyroscope.Rotation(first, second, rate_hint);
      if (!wheel || !turn || std::abs(wheel->forward_speed) < kMinSpeed || pair.IsStill()) continue;
      all.push_back(
          EquationsOf(pair, rig.cameras[camera], rig,
                      {ExpSo3(correction.gain * LogSo3(*turn)),
                       correction.gain * (gyroscope.RateAt(second) - gyroscope.RateAt(first)),
                       wheel->forward_speed * (pair.second - pair.first)}));
    }
  }
  return all;
}

/// What the gyroscope reads [rad/s] while images show that the car stands; nothing where they
/// hardly ever do, or where it turns meanwhile: then images are repeated.
std::optional<Eigen::Vector3d> RateAtRest(const std::vector<const ImagePairs*>& pairs,
                                          const GyroscopeHistory& gyroscope) {
  constexpr double kSteady = 0.02;      // [rad/s], of the rates' deviations
  constexpr std::size_t kMinStill = 3;  // pairs; one image may be repeated
  constexpr double kMinStop = 0.3;      // [s]; all cameras' images may be, at a time
  std::vector<Eigen::Vector3d> rates;
  TimeSpan span;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ImagePairs* of_camera : pairs) {
    if (!of_camera) continue;
    std::size_t hint = 0;
    for (const ImagePair& pair : of_camera->pairs()) {
      const auto turn = gyroscope.Rotation(pair.first, pair.second, hint);
      if (!turn || !pair.IsStill() || pair.from.empty()) continue;
      rates.emplace_back(LogSo3(*turn) / (pair.second - pair.first));
      sum += rates.back();
      span.Include(pair.first);
    }
  }
  if (rates.size() < kMinStill || span.Seconds() < kMinStop) return std::nullopt;
  const Eigen::Vector3d mean = sum / static_cast<double>(rates.size());
  const bool is_steady = std::all_of(rates.begin(), rates.end(), [&](const Eigen::Vector3d& rate) {
    return (rate - mean).norm() < kSteady;
  });
  return is_steady ? std::optional(mean) : std::nullopt;
}

/// One step of clipped least squares from `solution`, and what its covariance is made of.
struct NormalEquations {
  Information information = Information::Zero(), spread = Information::Zero();
  Unknowns gradient = Unknowns::Zero();
  double num_points = 0, num_near = 0;  ///< all, and those within the clip
};

/// \param speed_weight  [rad^2] of knowing a pair's speed; 0 where it is sure
NormalEquations SumUp(const std::vector<PairEquations>& all, const Unknowns& solution, double clip,
                      double speed_weight) {
  NormalEquations sums;
  for (const PairEquations& pair : all) {
    Unknowns of_pair = Unknowns::Zero(), with_speed = Unknowns::Zero();
    double of_speed = 0, speed_information = speed_weight;
    for (std::size_t i = 0; i < pair.residuals.size(); ++i) {
      const double residual = pair.residuals[i] + pair.jacobians[i].dot(solution);
      ++sums.num_points;
      if (std::abs(residual) > clip) continue;
      ++sums.num_near;
      sums.information += pair.jacobians[i] * pair.jacobians[i].transpose();
      of_pair += residual * pair.jacobians[i];
      with_speed += pair.by_speed[i] * pair.jacobians[i];
      speed_information += pair.by_speed[i] * pair.by_speed[i];
      of_speed += residual * pair.by_speed[i];
    }
    if (speed_weight > 0) {  // the pair's own speed, eliminated
      of_pair -= of_speed / speed_information * with_speed;
      sums.information -= with_speed * with_speed.transpose() / speed_information;
    }
    sums.gradient += of_pair;
    sums.spread += of_pair * of_pair.transpose();
  }
  return sums;
}

std::optional<GyroscopeFit> FitOnce(const Rig& rig, const std::vector<const ImagePairs*>& pairs,
                                    const GyroscopeHistory& gyroscope, const SpeedHistory& wheels,
                                    const Correction& correction, bool is_bias_known) {
  constexpr double kBiasSigma = 3e-4;  // [rad/s] where it is known
  constexpr double kWeak = 1e-9;       // where the car never turned that way, nothing is changed
  const std::vector<PairEquations> all = AllEquations(rig, pairs, gyroscope, wheels, correction);
  if (all.size() < kMinPairs) return std::nullopt;
  const double speed_weight =
      wheels.sigma() > 0 ? kPointSigma * kPointSigma / (wheels.sigma() * wheels.sigma()) : 0;
  Unknowns solution = Unknowns::Zero();
  Information covariance = Information::Zero();
  for (const double clip : {0.1, 0.1, 0.1, 0.04, 0.02, 0.01, 0.01}) {  // [rad]
    NormalEquations sums = SumUp(all, solution, clip, speed_weight);
    if (is_bias_known) {
      const double weight = kPointSigma * kPointSigma / (kBiasSigma * kBiasSigma);
      sums.information.diagonal().segment<3>(kConstantRate).array() += weight;
      sums.gradient.segment<3>(kConstantRate) += weight * solution.segment<3>(kConstantRate);
    }
    const Information inverse =
        (sums.information + kWeak * Information::Identity()).ldlt().solve(Information::Identity());
    solution -= inverse * sums.gradient;
    covariance = inverse * (sums.spread + kWeak * Information::Identity()) * inverse;
  }
  GyroscopeFit fit;
  for (Eigen::Index row = 0; row < 3; ++row)
    for (Eigen::Index column = 0; column < 3; ++column) {
      const Eigen::Index at = 3 * row + column;
      fit.true_from_read(row, column) += solution[at];
      fit.sigma(row, column) = std::sqrt(covariance(at, at));
    }
  for (const PairEquations& pair : all) fit.turned = std::hypot(fit.turned, pair.turned);
  const NormalEquations last = SumUp(all, solution, kNearPlane, speed_weight);
  fit.explained = last.num_near / std::max(last.num_points, 1.0);
  fit.bias = -solution.segment<3>(kConstantRate);
  fit.bias_sigma = std::sqrt(covariance.block<3, 3>(kConstantRate, kConstantRate).trace());
  fit.delay = solution[kDelayOf];
  fit.delay_sigma = std::sqrt(covariance(kDelayOf, kDelayOf));
  return fit;
}

}  // namespace

GyroscopeGain GainOf(const GyroscopeFit& fit) {
  // What no model of the points tells, as of reflections, is alike in all pairs of a drive. It
  // weighs little beside turns at corners, and much beside those of a street.
  constexpr double kUnmodeled = 2e-3;  // [rad] of the turns' root sum of squares
  double sum = 0, weight = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double of_axis = std::pow(fit.sigma(axis, axis), -2);
    sum += of_axis * fit.true_from_read(axis, axis);
    weight += of_axis;
  }
  return {sum / weight, std::hypot(1 / std::sqrt(weight), kUnmodeled / fit.turned)};
}

std::optional<GyroscopeFit> FitGyroscope(const Rig& rig,
                                         const std::vector<const ImagePairs*>& pairs,
                                         const GyroscopeHistory& gyroscope,
                                         const SpeedHistory& wheels) {
  const auto at_rest = RateAtRest(pairs, gyroscope);
  const Eigen::Vector3d known = at_rest.value_or(Eigen::Vector3d::Zero());
  std::optional<GyroscopeFit> fit =
      FitOnce(rig, pairs, gyroscope.Without(known), wheels, {}, at_rest.has_value());
  if (!fit) return std::nullopt;
  fit->bias += known;
  // Once more about rates that are nearly right, since rotations are linear in neither.
  const Correction correction{GainOf(*fit).gain, fit->delay};
  if (correction.gain < 0.5 || correction.gain > 2 || std::abs(correction.delay) > 0.5) return fit;
  std::optional<GyroscopeFit> again =
      FitOnce(rig, pairs, gyroscope.Without(fit->bias), wheels, correction, at_rest.has_value());
  if (!again) return fit;
  again->bias += fit->bias;
  again->true_from_read *= correction.gain;
  again->delay += correction.delay;
  return again;
}

}  // namespace parkade
