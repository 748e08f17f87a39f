#include "mapping/surface/ray_direction.h"

#include <cmath>
#include <numbers>

namespace parkade {
namespace {

constexpr double kPerRadian = kNumRayDirections / (2 * std::numbers::pi);
constexpr double kDoubt = 1e-3;  // parts of a turn: the error of ApproximateAngle is below half

/// The angle of (1, slope), for a slope of 0 to 1; to 1e-5 rad. M. Abramowitz, I. Stegun, "Handbook
/// of Mathematical Functions", 1964, 4.4.47.
double ApproximateAngle(double slope) {
  const double square = slope * slope;
  return slope *
         (0.9998660 + square * (-0.3302995 +
                                square * (0.1801410 + square * (-0.0851330 + square * 0.0208351))));
}

int ExactDirectionOf(const Eigen::Vector2d& ray) {
  const double turn = (std::atan2(ray.y(), ray.x()) + std::numbers::pi) / (2 * std::numbers::pi);
  return static_cast<int>(turn * kNumRayDirections) % kNumRayDirections;
}

}  // namespace

int DirectionOf(const Eigen::Vector2d& ray) {
  const double x = std::abs(ray.x()), y = std::abs(ray.y());
  if (!(x + y > 0)) return ExactDirectionOf(ray);
  double angle = x > y ? ApproximateAngle(y / x) : std::numbers::pi / 2 - ApproximateAngle(x / y);
  if (ray.x() < 0) angle = std::numbers::pi - angle;
  if (ray.y() < 0) angle = -angle;
  const double direction = (angle + std::numbers::pi) * kPerRadian;
  const int whole = static_cast<int>(direction);
  const double part = direction - whole;
  if (!(part > kDoubt && part < 1 - kDoubt)) return ExactDirectionOf(ray);
  return whole;
}

}  // namespace parkade
