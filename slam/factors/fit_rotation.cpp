#include "slam/factors/fit_rotation.h"

#include <algorithm>
#include <cmath>

#include "core/math/decompositions.h"
#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr size_t kMinPairs = 10;
constexpr int kReweightings = 6;
constexpr double kMinWidth = 1e-3;  // [rad] of the Cauchy weights
constexpr double kExplained = 0.3;  // share of the turn that may be left of an error

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

std::vector<double> Errors(const std::vector<DirectionPair>& pairs,
                           const Eigen::Quaterniond& turn) {
  std::vector<double> errors;
  for (const DirectionPair& pair : pairs)
    errors.push_back(AngleBetween(turn * pair.predicted, pair.measured));
  return errors;
}

}  // namespace

std::optional<Turn> FitRotation(const std::vector<DirectionPair>& pairs) {
  if (pairs.size() < kMinPairs) return std::nullopt;
  Turn turn;
  std::vector<double> errors = Errors(pairs, turn.measured_from_predicted);
  turn.error_before = Median(errors);
  for (int pass = 0; pass < kReweightings; ++pass) {
    const double width = std::max(kMinWidth, 2 * Median(errors));
    Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
    for (size_t i = 0; i < pairs.size(); ++i)
      correlation +=
          pairs[i].measured * pairs[i].predicted.transpose() / (1 + std::pow(errors[i] / width, 2));
    turn.measured_from_predicted = NearestRotation(correlation);
    errors = Errors(pairs, turn.measured_from_predicted);
  }
  turn.angle = turn.measured_from_predicted.angularDistance(Eigen::Quaterniond::Identity());
  turn.error_after = Median(errors);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double num_explained = 0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (errors[i] > std::max(kMinWidth, kExplained * turn.angle)) continue;
    sum += pairs[i].measured;
    ++num_explained;
  }
  turn.spread = num_explained > 0 ? 1 - sum.norm() / num_explained : 0;
  return turn;
}

}  // namespace parkade
