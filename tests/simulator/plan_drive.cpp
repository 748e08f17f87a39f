#include "tests/simulator/plan_drive.h"

#include <algorithm>
#include <cmath>

#include "tests/simulator/noise.h"
#include "tests/simulator/random.h"

namespace parkade::simulator {
namespace {

constexpr double kCornerRadius = 6.2;  // [m]
constexpr double kCornerRoom = 13;     // [m] between waypoints, so that corners fit
constexpr double kHighestSpeed = 6;    // [m/s]
constexpr double kLowestSpeed = 1.5;   // [m/s]
constexpr int kSpeedSteps = 20;        // bisection

/// Which rounds a drive makes: the long ones first.
struct Rounds {
  int num_long = 0, num_short = 0;
};

/// From the middle of the first aisle to a little beyond it, swinging from side to
/// side within the aisles as drivers do.
std::vector<Eigen::Vector2d> Waypoints(const LotLayout& layout, const Rounds& rounds, std::uint64_t seed) {
  Random random(seed, 0xd21e);
  const Eigen::Vector2d start = 0.55 * layout.short_loop[0] + 0.45 * layout.short_loop[1];
  const Eigen::Vector2d along = (layout.short_loop[1] - layout.short_loop[0]).normalized();
  std::vector<Eigen::Vector2d> points = {start};
  for (int round = 0; round < rounds.num_long + rounds.num_short; ++round) {
    const std::vector<Eigen::Vector2d>& loop = round < rounds.num_long ? layout.long_loop : layout.short_loop;
    for (size_t corner = 1; corner <= loop.size(); ++corner) {
      const Eigen::Vector2d from = points.back(), to = loop[corner % loop.size()];
      const Eigen::Vector2d side = (to - loop[corner - 1]).normalized();
      const Eigen::Vector2d left(-side.y(), side.x());
      const bool is_aisle = std::abs(side.x()) > 0.5;
      const double length = side.dot(to - from);
      const int num_swings = is_aisle ? std::max(0, static_cast<int>(length / kCornerRoom) - 1) : 0;
      for (int swing = 1; swing <= num_swings; ++swing)
        points.push_back(from + length * swing / (num_swings + 1) * side + random.Uniform(-0.7, 0.7) * left);
      points.push_back(to + random.Uniform(-0.3, 0.3) * (is_aisle ? side : left));
    }
  }
  points.push_back(start + 3.0 * along);
  return points;
}

/// Unevenness of the road under the wheels at a distance [m] along the route:
/// metres up, and radians of pitch and roll.
Eigen::Vector3d Roughness(double distance, std::uint32_t seed) {
  const float s = static_cast<float>(distance);
  return Eigen::Vector3d(0.0012 * FractalNoise(1.1f * s, 0.5f, 2, seed), 0.0012 * FractalNoise(0.8f * s, 1.5f, 2, seed),
                         0.0012 * FractalNoise(0.7f * s, 2.5f, 2, seed));
}

/// Body pose on the terrain at `time`.
PoseVector PoseOnTerrain(const Route& route, const SpeedProfile& profile, const Terrain& terrain, double time,
                         std::uint32_t seed) {
  constexpr double kPitchPerAcceleration = -0.004, kRollPerAcceleration = 0.006;  // [rad/(m/s^2)]
  const double distance = profile.Distance(time);
  const Eigen::Vector2d position = route.Position(distance);
  const double heading = route.Heading(distance), speed = profile.Speed(time);
  const Eigen::Vector2d gradient = terrain.Gradient(position.x(), position.y());
  const double slope_ahead = gradient.dot(Eigen::Vector2d(std::cos(heading), std::sin(heading)));
  const double slope_left = gradient.dot(Eigen::Vector2d(-std::sin(heading), std::cos(heading)));
  const Eigen::Vector3d shake = Roughness(distance, seed);
  const double lateral_acceleration = speed * speed * route.Curvature(distance);
  PoseVector pose;
  // Rotation about the left axis by +pitch lowers the nose.
  pose << position, terrain.Height(position.x(), position.y()) + shake[0], heading,
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

/// The rounds that fit into `duration` at a typical speed of 3 m/s; one short one when none fits.
Rounds ChooseRounds(const LotLayout& layout, double duration, std::uint64_t seed) {
  constexpr double kTypicalSpeed = 3, kStanding = 6.5;  // [m/s], [s]
  const double long_round = Route(Waypoints(layout, {1, 0}, seed), kCornerRadius).Length();
  const double short_round = Route(Waypoints(layout, {0, 1}, seed), kCornerRadius).Length();
  const double wanted = std::max(0.0, (duration - kStanding) * kTypicalSpeed);
  Rounds best{0, 1};
  double best_miss = std::abs(short_round - wanted);
  for (int num_long = 0; num_long * long_round < wanted + long_round; ++num_long) {
    const int num_short = std::max(0, static_cast<int>(std::lround((wanted - num_long * long_round) / short_round)));
    const double miss = std::abs(num_long * long_round + num_short * short_round - wanted);
    if (num_long + num_short == 0 || miss >= best_miss) continue;
    best = {num_long, num_short};
    best_miss = miss;
  }
  return best;
}

}  // namespace

DrivePlan PlanDrive(const LotLayout& layout, const Terrain& terrain, double duration, std::uint64_t seed) {
  const Route route(Waypoints(layout, ChooseRounds(layout, duration, seed), seed), kCornerRadius);
  const SpeedProfile profile(route, FitSpeed(route, duration));
  const std::uint32_t shake_seed = static_cast<std::uint32_t>(Mix64(seed));
  const auto pose_at = [&](double time) { return PoseOnTerrain(route, profile, terrain, time, shake_seed); };
  DrivePlan plan{Motion(pose_at, duration)};
  plan.length = profile.Distance(duration);
  plan.min_radius = MinRadius(route);
  for (double time = 0; time < duration; time += 0.05) plan.max_speed = std::max(plan.max_speed, profile.Speed(time));
  plan.returns_to_start = profile.Duration() <= duration + 1e-6;
  return plan;
}

}  // namespace parkade::simulator
