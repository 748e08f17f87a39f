#include "tests/simulator/drives/plan_drive.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/simulator/common/noise.h"
#include "tests/simulator/common/random.h"
#include "tests/simulator/layouts/parking_maneuver.h"
#include "tests/simulator/motion/speed_profile.h"
#include "tests/simulator/motion/suspension.h"
#include "tests/simulator/vehicle/car_mesh.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

constexpr double kLowestSpeed = 1.5;  // [m/s]
constexpr int kSpeedSteps = 20;       // bisection
constexpr double kHalfTrack = 0.74;   // [m] from the middle to a wheel

/// Unevenness of the road under the wheels at a way [m] along the route:
/// meters up, and radians of pitch and roll.
Eigen::Vector3d Roughness(double way, std::uint32_t seed) {
  const float s = static_cast<float>(way);
  return Eigen::Vector3d(0.0012 * FractalNoise(1.1f * s, 0.5f, 2, seed),
                         0.0012 * FractalNoise(0.8f * s, 1.5f, 2, seed),
                         0.0012 * FractalNoise(0.7f * s, 2.5f, 2, seed));
}

/// All that the body's pose follows from.
struct Ride {
  const DrivePath& path;
  const SpeedProfile& profile;
  const Suspension& suspension;
  const Ground& ground;
  std::uint32_t shake_seed;

  PoseVector PoseAt(double time) const {
    const PathPoint at = path.At(profile.LegAt(time), profile.DistanceInLeg(time));
    // It stands on its wheels: a bump lifts one axle after the other.
    const Eigen::Vector2d ahead(std::cos(at.heading), std::sin(at.heading)),
        left(-ahead.y(), ahead.x());
    const auto height_at = [&](const Eigen::Vector2d& wheel) {
      return ground.Height(wheel, at.near_z);
    };
    const double wheelbase = Wheelbase(kOwnCarStyle);
    const double on_left = height_at(at.position + kHalfTrack * left),
                 on_right = height_at(at.position - kHalfTrack * left),
                 rear = (on_left + on_right) / 2;
    const double slope_ahead = (height_at(at.position + wheelbase * ahead) - rear) / wheelbase;
    const double slope_left = (on_left - on_right) / (2 * kHalfTrack);
    const Eigen::Vector3d shake = Roughness(profile.Way(time), shake_seed);
    PoseVector pose;
    // Rotation about the left axis by +pitch lowers the nose.
    pose << at.position, rear + shake[0], at.heading,
        -std::atan(slope_ahead) + suspension.Pitch(time) + shake[1],
        std::atan(slope_left * std::cos(std::atan(slope_ahead))) + suspension.Roll(time) + shake[2];
    return pose;
  }
};

SpeedOptions SpeedOptionsOf(const DriverOptions& driver, double max_lateral_acceleration) {
  return {
      .max_speed = driver.max_speed,
      .max_lateral_acceleration = max_lateral_acceleration,
      .initial_stand = driver.initial_stand,
      .stops = driver.stops,
      .leg_stands = {0, driver.leaves_slot ? driver.parked_stand : 0},
      .final_stand = driver.parks && !driver.leaves_slot ? driver.parked_stand : driver.final_stand,
      .rolling_speed = driver.rolling_start};
}

/// With the slowest top speed for which the path is driven within `duration`, or the highest
/// allowed.
SpeedOptions FitSpeed(const DrivePath& path, const SpeedOptions& options, double duration) {
  SpeedOptions slow = options, fast = options;
  slow.max_speed = kLowestSpeed;
  for (int i = 0; i < kSpeedSteps; ++i) {
    SpeedOptions middle = fast;
    middle.max_speed = (slow.max_speed + fast.max_speed) / 2;
    (SpeedProfile(path, middle).Duration() > duration ? slow : fast) = middle;
  }
  return fast;
}

/// What is driven for `duration` [s] at an ordinary speed, without the time that the car stands.
double LengthFor(double duration, const DriverOptions& driver) {
  constexpr double kTypicalSpeed = 3, kSlowing = 1,
                   kParking = 12;  // [m/s], [s] lost at the start and in reverse
  const double standing = driver.initial_stand + driver.final_stand + kSlowing +
                          (driver.parks ? driver.parked_stand + kParking : 0) +
                          std::accumulate(driver.stops.begin(), driver.stops.end(), 0.0);
  return std::max(0.0, (duration - standing) * kTypicalSpeed);
}

/// The path, and whether it ends in a slot.
struct PlannedPath {
  DrivePath path;
  double max_lateral_acceleration = 0;  ///< [m/s^2]
  bool is_parked = false;
};

/// Leaves out the beginning of what is longer than `length` [m].
void StartLater(std::vector<Leg>& legs, double length) {
  Route& first = legs.front().route;
  first = first.Part(std::max(0.0, DrivePath(legs).Length() - length), first.Length());
}

PlannedPath PlanPath(const Place& place, const DriverOptions& driver, double duration,
                     std::uint64_t seed) {
  RouteWish wish{.length = driver.length > 0 ? driver.length : LengthFor(duration, driver),
                 .is_reversed = driver.is_opposite,
                 .turns_around = driver.turns_around,
                 .is_whole = driver.drives_last_part,
                 .ends_in_slot = driver.parks,
                 .seed = seed};
  RoutePlan plan = place.plan_route(wish);
  if (driver.parks) {
    if (auto legs = PlanParking(place, plan, driver.leaves_slot)) {
      if (driver.length > 0) StartLater(*legs, driver.length);
      return {DrivePath(std::move(*legs)), plan.max_lateral_acceleration, true};
    }
  }
  Route route(plan.waypoints, plan.corner_radius);
  if (driver.length == 0) return {DrivePath({{route, false}}), plan.max_lateral_acceleration};
  // Where no number of rounds has the length, a longer drive is cut off.
  constexpr double kTolerance = 0.08;
  for (int attempt = 0; attempt < 4 && route.Length() < (1 - kTolerance) * driver.length;
       ++attempt) {
    wish.length *= 1.3;
    plan = place.plan_route(wish);
    route = Route(plan.waypoints, plan.corner_radius);
  }
  const double spare = route.Length() - driver.length, begin = driver.drives_last_part ? spare : 0;
  if (spare > kTolerance * driver.length) route = route.Part(begin, begin + driver.length);
  return {DrivePath({{route, false}}), plan.max_lateral_acceleration};
}

}  // namespace

DrivePlan PlanDrive(const Place& place, double duration, std::uint64_t seed) {
  return PlanDrive(place, DriverOptions{}, duration, seed);
}

DrivePlan PlanDrive(const Place& place, const DriverOptions& driver, double duration,
                    std::uint64_t seed) {
  const PlannedPath planned = PlanPath(place, driver, duration, seed);
  const DrivePath& path = planned.path;
  const SpeedOptions speed = SpeedOptionsOf(driver, planned.max_lateral_acceleration);
  const SpeedProfile profile(path, driver.length > 0 ? speed : FitSpeed(path, speed, duration));
  const double end = driver.length > 0 ? profile.Duration() : duration;
  const auto push_at = [&](double time) {
    const double speed = profile.Speed(time), distance = profile.DistanceInLeg(time);
    return Suspension::Push{profile.Acceleration(time),
                            speed * speed * path.At(profile.LegAt(time), distance).curvature};
  };
  const Suspension suspension(push_at, end, driver.suspension);
  const Ride ride{path, profile, suspension, place.ground, static_cast<std::uint32_t>(Mix64(seed))};
  DrivePlan plan{Motion([&](double time) { return ride.PoseAt(time); }, end)};
  plan.length = profile.Traveled(end);
  plan.min_radius = path.MinRadius();
  for (double time = 0; time < end; time += 0.05)
    plan.max_speed = std::max(plan.max_speed, std::abs(profile.Speed(time)));
  const auto position_at = [&](double time) { return plan.motion.WorldFromBody(time).translation; };
  plan.returns_to_start = (position_at(end) - position_at(0)).norm() < 10;
  plan.num_reversals = static_cast<int>(path.legs().size()) - 1;
  plan.is_parked = planned.is_parked;
  return plan;
}

}  // namespace parkade::simulator
