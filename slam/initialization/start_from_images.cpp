// StartFromImages: hypotheses of the speed, adjusted; the scale from where it can be had.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "core/decompositions.h"
#include "slam/initialization/start_adjustment.h"
#include "slam/initialization/start_linearization.h"
#include "slam/initialization/start_motion.h"
#include "slam/initialization/start_problem.h"

namespace parkade {
namespace {

constexpr size_t kMinTracks = 15;
constexpr double kSpeeds[] = {0.7, 3, 10};  // [m/s] hypotheses
constexpr int kDirectionPasses = 4;
constexpr double kRobustAngle = 0.005;  // [rad] off the epipolar plane
constexpr int kFirstIterations = 12, kLastIterations = 8;
constexpr int kPasses = 2;          // at the noise that the pass before found
constexpr double kCorrelation = 6;  // variance: errors of a track last (docs/decisions/)
constexpr double kSystematic = 10;  // factor on the sigma of the scale that acceleration tells
constexpr double kSystematicScale =
    0.15;  // ground and IMU that differ by less do not contradict each other
constexpr double kMaxTiltSigma = 0.10;      // [rad]
constexpr double kMaxVelocitySigma = 0.15;  // [m/s] plus a share of the speed
constexpr double kMaxVelocityShare = 0.10, kMaxVelocityShareOfImu = 0.05;
// Handed on:
constexpr double kMinTiltSigma = 0.03;     // [rad]
constexpr double kMinVelocitySigma = 0.1;  // [m/s]
constexpr double kMinBiasSigma = 1e-3;     // [rad/s]
constexpr double kMaxNoise = 4;            // [sigma] of the median observation
constexpr int kGroundRounds = 3;
constexpr double kSameScale = 0.1;      // of its logarithm
constexpr double kMaxDisagreement = 3;  // [sigma] between scales
constexpr double kUnknownBias = 0.1;    // [m/s^2]
constexpr double kMinRest = 0.9;        // [s] after which a car that moves would show it
constexpr double kRestingSigmas = 3, kRestingShare = 0.75;

/// Direction of the velocity [unit] that suits the epipolar planes of first and last observations
/// best, at a speed.
Eigen::Vector3d DirectionAtSpeed(const StartProblem& problem, const Eigen::Vector3d& gravity,
                                 double speed) {
  StartMotion rest;
  rest.gravity = gravity;
  rest.bias = problem.linearized_at;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (int pass = 0; pass < kDirectionPasses; ++pass) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const StartTrack& track : problem.tracks) {
      const StartObservation &first = track.observations.front(), &last = track.observations.back();
      const StartImage &from = problem.images[first.image], &to = problem.images[last.image];
      const Eigen::Vector3d normal =
          (from.rotation * first.bearing).cross(to.rotation * last.bearing);
      const double time = to.t - from.t;
      if (!(time > 0)) continue;
      const double offset =
          normal.dot(CenterOf(to, rest, rest.bias) - CenterOf(from, rest, rest.bias)) / speed;
      const double error =
          pass == 0 ? 0 : (normal.dot(direction) * time + offset) / (time * kRobustAngle);
      const double weight = 1 / (1 + error * error);
      information += weight * time * time * normal * normal.transpose();
      right -= weight * time * offset * normal;
    }
    // Smallest on the unit sphere: (information + multiplier) direction = right.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
    const Eigen::Vector3d in_eigen = eigen.eigenvectors().transpose() * right;
    double low = -eigen.eigenvalues()[0], high = right.norm() + eigen.eigenvalues()[2];
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (low + high);
      const double norm =
          (in_eigen.array() / (eigen.eigenvalues().array() + middle)).matrix().norm();
      (norm > 1 ? low : high) = middle;
    }
    direction = eigen.eigenvectors() *
                (in_eigen.array() / (eigen.eigenvalues().array() + high).max(1e-12)).matrix();
    if (!(direction.norm() > 0.5)) direction = eigen.eigenvectors().col(0);
    direction.normalize();
  }
  return direction;
}

struct Candidate {
  StartProblem problem;  // with its points
  StartFit fit;
};

/// The best of all hypotheses, at the declared noise.
std::optional<Candidate> BestHypothesis(const StartProblem& problem,
                                        const Eigen::Vector3d& gravity) {
  std::optional<Candidate> best;
  for (const double speed : kSpeeds) {
    const Eigen::Vector3d direction = DirectionAtSpeed(problem, gravity, speed);
    Candidate candidate{problem, {}};
    StartMotion motion{speed * direction, gravity, problem.linearized_at};
    const double ahead = PlacePoints(candidate.problem, motion, 1);
    motion.velocity *= -1;
    StartProblem backwards = problem;
    if (PlacePoints(backwards, motion, 1) < ahead)
      candidate.problem = std::move(backwards);
    else
      motion.velocity *= -1;
    candidate.fit = Adjust(candidate.problem, motion, 1, kFirstIterations);
    if (!candidate.fit.motion.velocity.allFinite()) continue;
    if (!best || candidate.fit.cost < best->fit.cost) best = std::move(candidate);
  }
  return best;
}

/// Sigma of the logarithm of the way, by images and IMU. Errors that tracks and IMU keep over
/// seconds look like acceleration, which is all that tells scale here: hence far more than white
/// noise.
double ScaleSigma(const Candidate& candidate) {
  const Eigen::Vector3d way = WayOf(candidate.problem, candidate.fit.motion);
  const Eigen::Vector3d ahead = way.normalized();
  const double variance = ahead.dot(candidate.fit.covariance.topLeftCorner<3, 3>() * ahead);
  return kSystematic * std::sqrt(std::max(0.0, variance)) * candidate.problem.duration /
         std::max(way.norm(), 1e-3);
}

/// The same with everything larger by `factor`, adjusted to `scale` where it is given.
Candidate Rescaled(const Candidate& candidate, double factor,
                   const std::optional<ScalePrior>& scale, int iterations) {
  Candidate rescaled = candidate;
  StartMotion motion = candidate.fit.motion;
  motion.velocity *= factor;
  PlacePoints(rescaled.problem, motion, candidate.fit.noise);
  rescaled.problem.scale = scale;
  rescaled.fit = Adjust(rescaled.problem, motion, candidate.fit.noise, iterations);
  return rescaled;
}

struct KnownScale {
  double sigma = 0;  ///< of its logarithm; infinite where ground and IMU contradict each other
  bool is_of_ground = false;
};

/// Takes the scale from the ground where it is there to be seen.
KnownScale UseGround(Candidate& candidate, const Rig& rig) {
  std::optional<GroundScale> ground = MeasureGroundScale(candidate.problem, rig);
  for (int round = 0; round < kGroundRounds && ground && std::abs(ground->log_scale) > kSameScale;
       ++round) {
    Candidate rescaled = Rescaled(candidate, std::exp(ground->log_scale), {}, kFirstIterations);
    if (!(rescaled.fit.cost < candidate.fit.cost)) break;
    candidate = std::move(rescaled);
    ground = MeasureGroundScale(candidate.problem, rig);
  }
  const double sigma = ScaleSigma(candidate);
  if (!ground) return {sigma, false};
  if (std::abs(ground->log_scale) >
      kMaxDisagreement * std::hypot(ground->sigma, sigma, kSystematicScale))
    return {std::numeric_limits<double>::infinity(), true};
  const double way =
      WayOf(candidate.problem, candidate.fit.motion).norm() * std::exp(ground->log_scale);
  candidate = Rescaled(candidate, std::exp(ground->log_scale), ScalePrior{way, ground->sigma},
                       kLastIterations);
  return {1 / std::hypot(1 / sigma, 1 / ground->sigma), true};
}

/// Whether the car stands, by its images alone: a running motor may well shake the IMU.
bool IsAtRest(const StartProblem& problem) {
  double num_tracks = 0, num_resting = 0;
  for (const StartTrack& track : problem.tracks) {
    const StartObservation &first = track.observations.front(), &last = track.observations.back();
    const StartImage &from = problem.images[first.image], &to = problem.images[last.image];
    if (to.t - from.t < 0.5 * problem.duration) continue;
    const Eigen::Vector3d seen_first = from.rotation * first.bearing,
                          seen_last = to.rotation * last.bearing;
    ++num_tracks;
    num_resting +=
        seen_first.cross(seen_last).norm() < kRestingSigmas * std::hypot(first.sigma, last.sigma);
  }
  return problem.duration > kMinRest && num_tracks >= kMinTracks &&
         num_resting > kRestingShare * num_tracks;
}

StartEstimate MakeStart(const StartProblem& problem, const StartMotion& motion, Timestamp begin,
                        double tilt_sigma, double velocity_sigma) {
  StartEstimate start;
  start.kind = StartKind::kMovingInImages;
  start.state.time = begin;
  start.state.gyroscope_bias = motion.bias.gyroscope;
  start.state.odom_from_imu.rotation = LeveledRotation(motion.gravity);
  start.state.velocity_in_odom = start.state.odom_from_imu.rotation * motion.velocity;
  start.uncertainty = {kMinTiltSigma + tilt_sigma, kMinVelocitySigma + velocity_sigma,
                       std::max(3 * problem.gyroscope.sigma, kMinBiasSigma), kUnknownBias};
  return start;
}

}  // namespace

std::optional<StartEstimate> StartFromImages(const ImuBuffer& imu,
                                             const std::vector<TrackedFrame>& frames,
                                             const Rig& rig, const GyroscopeBiasEstimate& bias,
                                             Timestamp begin, Timestamp end) {
  const StartProblem problem = CollectStartProblem(imu, frames, rig, bias, begin, end);
  if (problem.tracks.size() < kMinTracks) return std::nullopt;
  const Eigen::Vector3d mean_gravity = MeanGravity(imu, problem.linearized_at, begin, end);
  if (IsAtRest(problem))
    return MakeStart(problem, {Eigen::Vector3d::Zero(), mean_gravity, problem.linearized_at}, begin,
                     0, 0);
  std::optional<Candidate> best = BestHypothesis(problem, mean_gravity);
  if (!best) return std::nullopt;
  for (int pass = 0; pass < kPasses; ++pass)
    best->fit = Adjust(best->problem, best->fit.motion, best->fit.noise, kLastIterations);
  const KnownScale scale = UseGround(*best, rig);

  const StartFit& fit = best->fit;
  if (!fit.covariance.allFinite()) return std::nullopt;
  const auto largest = [](const auto& matrix) {
    return std::sqrt(kCorrelation * std::max(0.0, SymmetricEigenvalues(matrix).maxCoeff()));
  };
  const double speed = fit.motion.velocity.norm();
  const double velocity_sigma =
      std::max(largest(fit.covariance.topLeftCorner<3, 3>()), speed * scale.sigma);
  const double tilt_sigma = largest(fit.covariance.block<2, 2>(3, 3));
  const double share = scale.is_of_ground ? kMaxVelocityShare : kMaxVelocityShareOfImu;
  if (!(fit.noise < kMaxNoise && tilt_sigma < kMaxTiltSigma &&
        velocity_sigma < kMaxVelocitySigma + share * speed))
    return std::nullopt;
  return MakeStart(problem, fit.motion, begin, tilt_sigma, velocity_sigma);
}

}  // namespace parkade
