// StartFromImages: hypotheses of the speed, adjusted; the scale from where it can be had.
#include <cmath>
#include <limits>

#include "core/math/decompositions.h"
#include "slam/initialization/start_adjustment.h"
#include "slam/initialization/start_hypotheses.h"
#include "slam/initialization/start_motion.h"
#include "slam/initialization/start_problem.h"

namespace parkade {
namespace {

constexpr size_t kMinTracks = 15;
constexpr int kFirstIterations = 12, kLastIterations = 8;
constexpr double kCoarseNoise = 3;    // at first, where the hypothesis is far off
constexpr int kPasses = 2;            // at the noise that the pass before found
constexpr double kCorrelation = 6;    // variance: errors of a track last (docs/decisions/)
constexpr double kSystematic = 14;    // factor on the sigma of the scale that acceleration tells
constexpr double kMountScale = 0.02;  // of the scale that mounts tell, which are never exact
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

struct Candidate {
  StartProblem problem;  // with its points
  StartFit fit;
};

/// The best of all hypotheses, at the declared noise.
std::optional<Candidate> BestHypothesis(const StartProblem& problem) {
  std::optional<Candidate> best;
  for (const StartMotion& motion : FindStartHypotheses(problem)) {
    Candidate candidate{problem, {}};
    PlacePoints(candidate.problem, motion, 1);
    candidate.fit = Adjust(candidate.problem, motion, kCoarseNoise, kFirstIterations);
    candidate.fit = Adjust(candidate.problem, candidate.fit.motion, 1, kFirstIterations);
    if (!candidate.fit.motion.velocity.allFinite()) continue;
    if (!best || candidate.fit.cost < best->fit.cost) best = std::move(candidate);
  }
  return best;
}

/// How well the scale of a start is known.
struct KnownScale {
  double sigma = 0;  ///< of its logarithm; infinite where ground and IMU contradict each other
  bool is_measured = false;  ///< by the ground or by cameras that see the same, not by acceleration
};

double VarianceOfScale(const StartProblem& problem, const StartFit& fit) {
  const Eigen::Vector3d way = WayOf(problem, fit.motion), ahead = way.normalized();
  const double variance = ahead.dot(fit.covariance.topLeftCorner<3, 3>() * ahead);
  return std::max(0.0, variance) * std::pow(problem.duration / std::max(way.norm(), 1e-3), 2);
}

/// Errors that tracks and IMU keep over seconds look like acceleration: where that alone tells
/// scale, sigma is far more than white noise has it. Cameras that see the same are only as
/// good as their mounts.
KnownScale KnowScale(const Candidate& candidate) {
  Candidate apart = candidate;
  for (StartTrack& track : apart.problem.tracks) {
    const auto camera_of = [&](const StartObservation& seen) {
      return apart.problem.images[seen.image].camera;
    };
    std::erase_if(track.observations,
                  [&, first = camera_of(track.observations.front())](const StartObservation& seen) {
                    return camera_of(seen) != first;
                  });
  }
  const StartFit of_acceleration =
      Adjust(apart.problem, candidate.fit.motion, candidate.fit.noise, 0);
  const double together = 1 / VarianceOfScale(candidate.problem, candidate.fit);
  const double by_acceleration = 1 / VarianceOfScale(apart.problem, of_acceleration);
  const double by_overlap = std::max(0.0, together - by_acceleration);
  const double overlap_sigma =
      std::hypot(std::sqrt(kCorrelation / std::max(by_overlap, 1e-12)), kMountScale);
  const double acceleration_sigma = kSystematic / std::sqrt(by_acceleration);
  return {1 / std::hypot(1 / overlap_sigma, 1 / acceleration_sigma),
          overlap_sigma < acceleration_sigma};
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
  const KnownScale without = KnowScale(candidate);
  if (!ground) return without;
  if (std::abs(ground->log_scale) >
      kMaxDisagreement * std::hypot(ground->sigma, without.sigma, kSystematicScale))
    return {std::numeric_limits<double>::infinity(), true};
  const double way =
      WayOf(candidate.problem, candidate.fit.motion).norm() * std::exp(ground->log_scale);
  candidate = Rescaled(candidate, std::exp(ground->log_scale), ScalePrior{way, ground->sigma},
                       kLastIterations);
  return {1 / std::hypot(1 / without.sigma, 1 / ground->sigma), true};
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
  const Eigen::Vector3d rest = Eigen::Vector3d::Zero();
  if (IsAtRest(problem))
    return MakeStart(problem, {rest, SteadyGravity(problem, rest), problem.linearized_at}, begin, 0,
                     0);
  std::optional<Candidate> best = BestHypothesis(problem);
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
  // Along the velocity sigma is that of the scale, which must not be widened once more.
  const Eigen::Vector3d ahead = fit.motion.velocity.stableNormalized();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ahead * ahead.transpose();
  const double velocity_sigma = std::max(
      largest(across * fit.covariance.topLeftCorner<3, 3>() * across), speed * scale.sigma);
  const double tilt_sigma = largest(fit.covariance.block<2, 2>(3, 3));
  const double share = scale.is_measured ? kMaxVelocityShare : kMaxVelocityShareOfImu;
  if (!(fit.noise < kMaxNoise && tilt_sigma < kMaxTiltSigma &&
        velocity_sigma < kMaxVelocitySigma + share * speed))
    return std::nullopt;
  return MakeStart(problem, fit.motion, begin, tilt_sigma, velocity_sigma);
}

}  // namespace parkade
