#pragma once

#include <Eigen/Core>

namespace parkade {

/// Errors of a receiver, in units of the sigma that it claims: a slow part, Gauss-Markov of first
/// order, and a white one; their variances add up to 1.
struct ErrorModel {
  double correlation_time = 60;  ///< [s] of the slow part; 0: all is white
  double white_variance = 0.1;   ///< share of the variance, (0, 1]
};

/// Turns rows of a least-squares problem whose errors are correlated into rows with independent
/// errors of unit variance: the innovations of a Kalman filter over the slow part, for each column
/// in the same way, which equals multiplying by the inverse square root of the series' covariance.
/// O(n). A. C. Harvey, "Forecasting, structural time series models and the Kalman filter", 1990,
/// section 3.4.2.
///
/// \param rows     n x m, each [Jacobian | residual] of a measurement, divided by its sigma
/// \param times    [s] n, not decreasing
/// \param weights  n, (0, 1]: how far each is believed; its white variance is divided by it
Eigen::MatrixXd WhitenRows(const Eigen::MatrixXd& rows, const Eigen::VectorXd& times,
                           const Eigen::VectorXd& weights, const ErrorModel& model);

/// The white share of the variance of a series, from the differences of successive values.
///
/// \param values  n, in units of their sigmas
/// \param times   [s] n; pairs further apart than a second are left out
/// \return in [0.01, 1]; 1 where there are too few pairs to tell
double EstimateWhiteVariance(const Eigen::VectorXd& values, const Eigen::VectorXd& times,
                             double correlation_time);

}  // namespace parkade
