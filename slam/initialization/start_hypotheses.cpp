#include "slam/initialization/start_hypotheses.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "slam/initialization/start_adjustment.h"
#include "slam/initialization/start_linearization.h"

namespace parkade {
namespace {

constexpr double kSlowest = 0.3;  // [m/s]
constexpr double kStep = 1.35;    // between speeds that are tried
constexpr int kNumSpeeds = 18;    // up to 50 m/s
constexpr size_t kMaxHypotheses = 3;
constexpr double kScanNoise = 3;  // widens the valleys, so that a step does not pass one over
constexpr int kRounds = 3;        // of direction and down, which need each other
constexpr int kDirectionPasses = 4;
constexpr double kRobustAngle = 0.005;  // [rad] off the epipolar plane

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

struct Hypothesis {
  StartMotion motion;
  double cost = 0;
};

/// The better of ahead and backwards at one speed.
Hypothesis AtSpeed(const StartProblem& problem, double speed) {
  std::optional<Hypothesis> best;
  for (const double sign : {1.0, -1.0}) {
    StartMotion motion{Eigen::Vector3d::Zero(), SteadyGravity(problem, Eigen::Vector3d::Zero()),
                       problem.linearized_at};
    for (int round = 0; round < kRounds; ++round) {
      // The planes do not tell the sign of the direction, which the first round fixes.
      Eigen::Vector3d direction = DirectionAtSpeed(problem, motion.gravity, speed);
      if (round == 0 ? sign < 0 : direction.dot(motion.velocity) < 0) direction = -direction;
      motion.velocity = speed * direction;
      motion.gravity = SteadyGravity(problem, motion.velocity);
    }
    StartProblem placed = problem;
    const double cost = PlacePoints(placed, motion, kScanNoise);
    if (!best || cost < best->cost) best = Hypothesis{motion, cost};
  }
  return *best;
}

}  // namespace

std::vector<StartMotion> FindStartHypotheses(const StartProblem& problem) {
  std::vector<Hypothesis> scan;
  scan.reserve(kNumSpeeds);
  for (int k = 0; k < kNumSpeeds; ++k)
    scan.push_back(AtSpeed(problem, kSlowest * std::pow(kStep, k)));
  std::vector<Hypothesis> valleys;
  for (size_t i = 0; i < scan.size(); ++i)
    if ((i == 0 || scan[i].cost <= scan[i - 1].cost) &&
        (i + 1 == scan.size() || scan[i].cost < scan[i + 1].cost))
      valleys.push_back(scan[i]);
  std::sort(valleys.begin(), valleys.end(),
            [](const Hypothesis& a, const Hypothesis& b) { return a.cost < b.cost; });
  if (valleys.size() > kMaxHypotheses) valleys.resize(kMaxHypotheses);
  std::vector<StartMotion> motions;
  motions.reserve(valleys.size());
  for (const Hypothesis& valley : valleys) motions.push_back(valley.motion);
  return motions;
}

}  // namespace parkade
