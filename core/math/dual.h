#pragma once

#include <Eigen/Core>
#include <cmath>

namespace parkade {

/// A number with its derivatives by N variables: forward-mode differentiation
/// where the code to be differentiated is short. Members are named as in
/// ceres::Jet, so that one template serves both.
template <int N>
struct Dual {
  using Derivatives = Eigen::Matrix<double, N, 1>;

  double a = 0;
  Derivatives v = Derivatives::Zero();

  Dual() = default;
  Dual(double value) : a(value) {}  // NOLINT(google-explicit-constructor): constants mix with duals
  Dual(double value, const Derivatives& derivatives) : a(value), v(derivatives) {}
  /// The `index`-th variable itself.
  static Dual Variable(double value, int index) { return {value, Derivatives::Unit(index)}; }

  friend Dual operator-(const Dual& x) { return {-x.a, -x.v}; }
  friend Dual operator+(const Dual& x, const Dual& y) { return {x.a + y.a, x.v + y.v}; }
  friend Dual operator-(const Dual& x, const Dual& y) { return {x.a - y.a, x.v - y.v}; }
  friend Dual operator*(const Dual& x, const Dual& y) { return {x.a * y.a, x.v * y.a + y.v * x.a}; }
  friend Dual operator/(const Dual& x, const Dual& y) {
    const double inverse = 1 / y.a;
    const double quotient =
        x.a / y.a;  // rounded as for doubles: same value with and without derivatives
    return {quotient, (x.v - quotient * y.v) * inverse};
  }
  friend Dual operator+(const Dual& x, double s) { return {x.a + s, x.v}; }
  friend Dual operator+(double s, const Dual& x) { return {s + x.a, x.v}; }
  friend Dual operator-(const Dual& x, double s) { return {x.a - s, x.v}; }
  friend Dual operator-(double s, const Dual& x) { return {s - x.a, -x.v}; }
  friend Dual operator*(const Dual& x, double s) { return {x.a * s, x.v * s}; }
  friend Dual operator*(double s, const Dual& x) { return {x.a * s, x.v * s}; }
  friend Dual operator/(const Dual& x, double s) { return {x.a / s, x.v / s}; }

  friend Dual sqrt(const Dual& x) {
    const double root = std::sqrt(x.a);
    return {root, x.v * (0.5 / root)};
  }
  friend Dual atan2(const Dual& y, const Dual& x) {
    const double scale = 1 / (x.a * x.a + y.a * y.a);
    return {std::atan2(y.a, x.a), (x.a * scale) * y.v - (y.a * scale) * x.v};
  }
};

/// The number without its derivatives. Takes a double, a Dual or a ceres::Jet.
template <typename T>
double ValueOf(const T& x) {
  if constexpr (requires { x.a; }) {
    return ValueOf(x.a);
  } else {
    return static_cast<double>(x);
  }
}

}  // namespace parkade
