#include "slam/initialization/start_adjustment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/decompositions.h"
#include "core/math/statistics.h"
#include "slam/factors/landmark_parameters.h"
#include "slam/initialization/start_linearization.h"

namespace parkade {
namespace {

using MotionVector = Eigen::Matrix<double, kStartMotionSize, 1>;

constexpr double kRobustWidth = 2;               // [sigma] Cauchy
constexpr double kMaxInverseDistance = 1 / 0.3;  // [1/m]
constexpr int kLinearPasses = 3;
constexpr int kPointIterations = 6;
constexpr double kRayDamping = 1;          // [1/rad^2] keeps points that are behind solvable
constexpr double kInfinityDamping = 1e-6;  // [1/(1/m)^2] keeps points without parallax solvable
constexpr double kMedianOfChiSquared2 = 1.386;
constexpr double kMinNoise = 0.2, kMaxNoise = 10;
constexpr double kEnough = 1e-4;  // relative fall of the cost

double RobustCost(double squared) {
  return kRobustWidth * kRobustWidth * std::log1p(squared / (kRobustWidth * kRobustWidth));
}
double RobustWeight(double squared) { return 1 / (1 + squared / (kRobustWidth * kRobustWidth)); }

struct TrackEquations {
  Eigen::Matrix3d points = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, kStartMotionSize> cross =
      Eigen::Matrix<double, 3, kStartMotionSize>::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double cost = 0;
};

struct MotionEquations {
  StartMotionMatrix information = StartMotionMatrix::Zero();
  MotionVector gradient = MotionVector::Zero();
  double cost = 0;
};

TrackEquations Accumulate(const StartTrack& track, const std::vector<PlacedStartImage>& images,
                          double noise, MotionEquations* motion) {
  TrackEquations own;
  const Eigen::Matrix<double, 3, 2> across = BasisAcross(track.ray);
  for (const StartObservation& observation : track.observations) {
    const StartResidual at = LinearizeStart(track, across, observation, images[observation.image],
                                            noise, motion != nullptr);
    const double squared = at.residual.squaredNorm(), weight = RobustWeight(squared);
    own.cost += RobustCost(squared);
    own.points += weight * at.by_point.transpose() * at.by_point;
    own.gradient += weight * at.by_point.transpose() * at.residual;
    if (!motion) continue;
    own.cross += weight * at.by_point.transpose() * at.by_motion;
    motion->information += weight * at.by_motion.transpose() * at.by_motion;
    motion->gradient += weight * at.by_motion.transpose() * at.residual;
  }
  own.points.diagonal() += Eigen::Vector3d(kRayDamping, kRayDamping, kInfinityDamping);
  return own;
}

void MovePoint(StartTrack& track, const Eigen::Vector3d& step) {
  const Eigen::Vector3d ray = track.ray + BasisAcross(track.ray) * step.head<2>();
  const double scale = 1 / ray.norm();
  track.inverse_distance =
      std::clamp((track.inverse_distance + step.z()) * scale, 0.0, kMaxInverseDistance);
  track.ray = scale * ray;
}

/// What is known of biases and scale without images.
void AddPriors(const StartProblem& problem, const StartMotion& motion, MotionEquations& equations) {
  const auto add = [&](const Eigen::Matrix<double, 1, kStartMotionSize>& row, double residual) {
    equations.information += row.transpose() * row;
    equations.gradient += row.transpose() * residual;
    equations.cost += residual * residual;
  };
  for (int k = 0; k < 3; ++k) {
    Eigen::Matrix<double, 1, kStartMotionSize> row =
        Eigen::Matrix<double, 1, kStartMotionSize>::Zero();
    row[5 + k] = 1 / problem.gyroscope.sigma;
    add(row, (motion.bias.gyroscope[k] - problem.gyroscope.bias[k]) / problem.gyroscope.sigma);
    row.setZero();
    row[8 + k] = 1 / problem.accelerometer_bias_sigma;
    add(row, motion.bias.accelerometer[k] / problem.accelerometer_bias_sigma);
  }
  if (!problem.scale) return;
  const PlacedStartImage end = PlaceStartImage(problem.end, motion, problem.linearized_at);
  const double way = std::max(end.center.norm(), 1e-3);
  add(end.center.transpose() / (way * way) * end.center_by_motion / problem.scale->sigma,
      std::log(way / problem.scale->way) / problem.scale->sigma);
}

StartMotion Moved(const StartMotion& motion, const MotionVector& step) {
  StartMotion moved = motion;
  moved.velocity += step.head<3>();
  moved.gravity = motion.gravity.norm() *
                  (motion.gravity + GravityBasis(motion.gravity) * step.segment<2>(3)).normalized();
  moved.bias.gyroscope += step.segment<3>(5);
  moved.bias.accelerometer += step.tail<3>();
  return moved;
}

std::vector<PlacedStartImage> PlaceImages(const StartProblem& problem, const StartMotion& motion) {
  std::vector<PlacedStartImage> images;
  images.reserve(problem.images.size());
  for (const StartImage& image : problem.images)
    images.push_back(PlaceStartImage(image, motion, problem.linearized_at));
  return images;
}

double CostOf(const StartProblem& problem, const StartMotion& motion, double noise) {
  const std::vector<PlacedStartImage> images = PlaceImages(problem, motion);
  MotionEquations priors;
  AddPriors(problem, motion, priors);
  double cost = priors.cost;
  for (const StartTrack& track : problem.tracks)
    for (const StartObservation& observation : track.observations)
      cost += RobustCost(LinearizeStart(track, BasisAcross(track.ray), observation,
                                        images[observation.image], noise, false)
                             .residual.squaredNorm());
  return cost;
}

/// Equations of the motion with all points eliminated.
MotionEquations Reduce(const StartProblem& problem, const StartMotion& motion, double noise,
                       double damping, std::vector<TrackEquations>& tracks) {
  const std::vector<PlacedStartImage> images = PlaceImages(problem, motion);
  MotionEquations equations;
  AddPriors(problem, motion, equations);
  tracks.clear();
  for (const StartTrack& track : problem.tracks) {
    TrackEquations& own = tracks.emplace_back(Accumulate(track, images, noise, &equations));
    own.points.diagonal() *= 1 + damping;
    const Eigen::Matrix<double, kStartMotionSize, 3> gain =
        own.cross.transpose() * own.points.inverse();
    equations.information -= gain * own.cross;
    equations.gradient -= gain * own.gradient;
    equations.cost += own.cost;
  }
  equations.information.diagonal() *= 1 + damping;
  return equations;
}

/// Median of the squared errors against what white noise of the declared sigmas would leave.
double NoiseOf(const StartProblem& problem, const StartMotion& motion) {
  const std::vector<PlacedStartImage> images = PlaceImages(problem, motion);
  std::vector<double> squared;
  for (const StartTrack& track : problem.tracks)
    for (const StartObservation& observation : track.observations)
      squared.push_back(LinearizeStart(track, BasisAcross(track.ray), observation,
                                       images[observation.image], 1, false)
                            .residual.squaredNorm());
  if (squared.empty()) return 1;
  const double median = NthSmallest(squared, squared.size() / 2);
  const double freedom = std::max(0.3, 1 - 1.5 * static_cast<double>(problem.tracks.size()) /
                                               static_cast<double>(squared.size()));
  return std::clamp(std::sqrt(median / kMedianOfChiSquared2 / freedom), kMinNoise, kMaxNoise);
}

/// [1/m] at which rays of known places come nearest to the track's own, by linear least squares:
/// from infinity a near point of a fast car would not be found.
double LinearInverseDistance(const StartTrack& track, const std::vector<PlacedStartImage>& images) {
  double inverse_distance = 0;
  for (int pass = 0; pass < kLinearPasses; ++pass) {
    double numerator = 0, denominator = 0;
    for (const StartObservation& observation : track.observations) {
      const PlacedStartImage& image = images[observation.image];
      const Eigen::Vector3d seen = image.rotation * observation.bearing,
                            offset = track.origin - image.center;
      const double weight = 1 / (track.ray + inverse_distance * offset).squaredNorm();
      numerator -= weight * seen.cross(track.ray).dot(seen.cross(offset));
      denominator += weight * seen.cross(offset).squaredNorm();
    }
    if (!(denominator > 1e-12)) return 0;
    inverse_distance = std::clamp(numerator / denominator, 0.0, kMaxInverseDistance);
  }
  return inverse_distance;
}

}  // namespace

Eigen::Vector3d WayOf(const StartProblem& problem, const StartMotion& motion) {
  return CenterOf(problem.end, motion, problem.linearized_at);
}

double PlacePoints(StartProblem& problem, const StartMotion& motion, double noise) {
  const std::vector<PlacedStartImage> images = PlaceImages(problem, motion);
  for (StartTrack& track : problem.tracks) {
    const StartObservation& first = track.observations.front();
    track.origin = images[first.image].center;
    track.ray = images[first.image].rotation * first.bearing;
    track.inverse_distance = LinearInverseDistance(track, images);
    double cost = std::numeric_limits<double>::infinity();
    StartTrack best = track;
    for (int i = 0; i < kPointIterations; ++i) {
      const TrackEquations own = Accumulate(track, images, noise, nullptr);
      if (!(own.cost < cost)) break;
      cost = own.cost;
      best = track;
      MovePoint(track, -SolveSymmetric(own.points, own.gradient));
    }
    track = std::move(best);
  }
  return CostOf(problem, motion, noise);
}

StartFit Adjust(StartProblem& problem, const StartMotion& from, double noise, int max_iterations) {
  StartFit fit;
  fit.motion = from;
  fit.cost = CostOf(problem, from, noise);
  double damping = 1e-3;
  std::vector<TrackEquations> tracks;
  for (int i = 0; i < max_iterations && damping < 1e3; ++i) {
    const MotionEquations equations = Reduce(problem, fit.motion, noise, damping, tracks);
    const MotionVector step = -equations.information.ldlt().solve(equations.gradient);
    if (!step.allFinite()) break;
    const std::vector<StartTrack> before = problem.tracks;
    for (size_t k = 0; k < tracks.size(); ++k)
      MovePoint(problem.tracks[k],
                -SolveSymmetric(tracks[k].points, tracks[k].gradient + tracks[k].cross * step));
    const StartMotion moved = Moved(fit.motion, step);
    const double cost = CostOf(problem, moved, noise);
    if (cost < fit.cost) {
      const bool is_enough = fit.cost - cost < kEnough * fit.cost;
      fit.motion = moved;
      fit.cost = cost;
      damping = std::max(1e-6, 0.1 * damping);
      if (is_enough) break;
    } else {
      problem.tracks = before;
      damping *= 10;
    }
  }
  fit.noise = NoiseOf(problem, fit.motion);
  const MotionEquations equations = Reduce(problem, fit.motion, fit.noise, 0, tracks);
  for (size_t k = 0; k < tracks.size(); ++k)
    problem.tracks[k].inverse_distance_sigma =
        std::sqrt(std::max(0.0, tracks[k].points.inverse()(2, 2)));
  const Eigen::LLT<StartMotionMatrix> information(equations.information);
  fit.covariance.setConstant(std::numeric_limits<double>::infinity());
  if (information.info() == Eigen::Success)
    fit.covariance = information.solve(StartMotionMatrix::Identity());
  return fit;
}

}  // namespace parkade
