#include "slam/georeference/correlated_errors.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr double kPairsApart = 1.0;  // [s]
constexpr size_t kMinPairs = 10;
constexpr double kLeastWhiteVariance = 0.01;  // receivers smooth; nothing is exact
constexpr double kMedianChiSquared = 0.4549;  // of one degree of freedom

/// How much of the slow part is left after some time.
double Memory(double elapsed, double correlation_time) {
  return correlation_time > 0 ? std::exp(-elapsed / correlation_time) : 0.0;
}

}  // namespace

Eigen::MatrixXd WhitenRows(const Eigen::MatrixXd& rows, const Eigen::VectorXd& times,
                           const Eigen::VectorXd& weights, const ErrorModel& model) {
  assert(rows.rows() == times.size() && rows.rows() == weights.size());
  const double slow_variance = 1 - model.white_variance;
  Eigen::MatrixXd white(rows.rows(), rows.cols());
  Eigen::RowVectorXd slow =
      Eigen::RowVectorXd::Zero(rows.cols());  // what is expected of each column
  double variance = slow_variance;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    if (i > 0) {
      const double memory = Memory(times[i] - times[i - 1], model.correlation_time);
      slow *= memory;
      variance = memory * memory * variance + (1 - memory * memory) * slow_variance;
    }
    const double innovation_variance = variance + model.white_variance / weights[i];
    const Eigen::RowVectorXd innovation = rows.row(i) - slow;
    white.row(i) = innovation / std::sqrt(innovation_variance);
    const double gain = variance / innovation_variance;
    slow += gain * innovation;
    variance *= 1 - gain;
  }
  return white;
}

double EstimateWhiteVariance(const Eigen::VectorXd& values, const Eigen::VectorXd& times,
                             double correlation_time) {
  std::vector<double> shares;
  for (Eigen::Index i = 1; i < values.size(); ++i) {
    const double elapsed = times[i] - times[i - 1];
    if (elapsed > kPairsApart) continue;
    // E (v1 - v0)^2 = 2 w + 2 (1 - w) (1 - memory)
    const double memory = Memory(elapsed, correlation_time);
    const double step = values[i] - values[i - 1];
    shares.push_back(0.5 * step * step - kMedianChiSquared * (1 - memory));
  }
  if (shares.size() < kMinPairs) return 1;
  return std::clamp(Median(std::move(shares)) / kMedianChiSquared, kLeastWhiteVariance, 1.0);
}

}  // namespace parkade
