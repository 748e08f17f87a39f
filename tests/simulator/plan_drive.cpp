#include "tests/simulator/plan_drive.h"

#include <algorithm>
#include <cmath>

#include "tests/simulator/noise.h"
#include "tests/simulator/random.h"

namespace parkade::simulator {
namespace {

constexpr double kHighestSpeed = 6;   // [m/s]
constexpr double kLowestSpeed = 1.5;  // [m/s]
constexpr int kSpeedSteps = 20;       // bisection

/// Unevenness of the road under the wheels at a distance [m] along the route:
/// metres up, and radians of pitch and roll.
Eigen::Vector3d Roughness(double distance, std::uint32_t seed) {
  const float s = static_cast<float>(distance);
  return Eigen::Vector3d(0.0012 * FractalNoise(1.1f * s, 0.5f, 2, seed), 0.0012 * FractalNoise(0.8f * s, 1.5f, 2, seed),
                         0.0012 * FractalNoise(0.7f * s, 2.5f, 2, seed));
}

/// Body pose on the ground at `time`.
PoseVector PoseOnGround(const Route& route, const SpeedProfile& profile, const Ground& ground, double time,
                        std::uint32_t seed) {
  constexpr double kPitchPerAcceleration = -0.004, kRollPerAcceleration = 0.006;  // [rad/(m/s^2)]
  const double distance = profile.Distance(time);
  const Eigen::Vector2d position = route.Position(distance);
  const double heading = route.Heading(distance), near_z = route.HeightHint(distance), speed = profile.Speed(time);
  const Eigen::Vector2d gradient = ground.Gradient(position, near_z);
  const double slope_ahead = gradient.dot(Eigen::Vector2d(std::cos(heading), std::sin(heading)));
  const double slope_left = gradient.dot(Eigen::Vector2d(-std::sin(heading), std::cos(heading)));
  const Eigen::Vector3d shake = Roughness(distance, seed);
  const double lateral_acceleration = speed * speed * route.Curvature(distance);
  PoseVector pose;
  // Rotation about the left axis by +pitch lowers the nose.
  pose << position, ground.Height(position, near_z) + shake[0], heading,
      -std::atan(slope_ahead) + kPitchPerAcceleration * profile.Acceleration(time) + shake[1],
      std::atan(slope_left * std::cos(std::atan(slope_ahead))) + kRollPerAcceleration * lateral_acceleration + shake[2];
  return pose;
}

/// The slowest top speed for which the route is driven within `duration`, or the
/// highest allowed.
SpeedOptions FitSpeed(const Route& route, double duration) {
  SpeedOptions slow, fast;
  slow.max_speed = kLowestSpeed;
  fast.max_speed = kHighestSpeed;
  for (int i = 0; i < kSpeedSteps; ++i) {
    SpeedOptions middle;
    middle.max_speed = (slow.max_speed + fast.max_speed) / 2;
    (SpeedProfile(route, middle).Duration() > duration ? slow : fast) = middle;
  }
  return fast;
}

double MinRadius(const Route& route) {
  double max_curvature = 1e-9;
  for (double s = 0; s < route.Length(); s += 0.05)
    max_curvature = std::max(max_curvature, std::abs(route.Curvature(s)));
  return 1 / max_curvature;
}

}  // namespace

DrivePlan PlanDrive(const Place& place, double duration, std::uint64_t seed) {
  constexpr double kTypicalSpeed = 3, kStanding = 6.5;  // [m/s], [s]
  const RoutePlan wanted =
      place.plan_route({.length = std::max(0.0, (duration - kStanding) * kTypicalSpeed), .seed = seed});
  const Route route(wanted.waypoints, wanted.corner_radius);
  const SpeedProfile profile(route, FitSpeed(route, duration));
  const std::uint32_t shake_seed = static_cast<std::uint32_t>(Mix64(seed));
  const auto pose_at = [&](double time) { return PoseOnGround(route, profile, place.ground, time, shake_seed); };
  DrivePlan plan{Motion(pose_at, duration)};
  plan.length = profile.Distance(duration);
  plan.min_radius = MinRadius(route);
  for (double time = 0; time < duration; time += 0.05) plan.max_speed = std::max(plan.max_speed, profile.Speed(time));
  plan.returns_to_start = profile.Duration() <= duration + 1e-6;
  return plan;
}

}  // namespace parkade::simulator
