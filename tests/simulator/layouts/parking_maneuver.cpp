#include "tests/simulator/layouts/parking_maneuver.h"

#include <algorithm>
#include <cmath>

#include "tests/simulator/vehicle/car_mesh.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

constexpr double kClearance = 0.15;  // [m]
constexpr double kStraightEnd =
    2.2;  // [m] behind the curve into the slot, before the direction changes

/// Corners of the way into a slot.
struct Approach {
  Eigen::Vector3d straightens;  ///< where the car is in line with the aisle
  Eigen::Vector3d far_end;      ///< where it changes its direction
  Eigen::Vector3d corner;       ///< of the aisle and the slot's axis
  Eigen::Vector3d parked;       ///< of the rear axle
};

/// With a curve of `radius` between aisle and slot, on a line `aside` [m] beside the route's own,
/// away from the slot.
std::optional<Approach> ApproachTo(const ParkingSlot& slot, const RoutePlan& plan, double radius,
                                   double aside) {
  const Eigen::Vector3d &from = plan.waypoints[plan.waypoints.size() - 2],
                        &to = plan.waypoints.back();
  const Eigen::Vector2d along = (to - from).head<2>().normalized();
  const Eigen::Vector2d inward(std::cos(slot.outline.yaw), std::sin(slot.outline.yaw));
  if (std::abs(along.dot(inward)) > 0.05) return std::nullopt;  // not square to the aisle
  const Eigen::Vector2d aisle = from.head<2>() - aside * inward;
  const double ahead = along.dot(slot.outline.center - aisle),
               beside = inward.dot(slot.outline.center - aisle);
  if (beside < 3 || beside > 9) return std::nullopt;
  const double run_up = ahead - radius;
  if (run_up < 4) return std::nullopt;
  const Eigen::Vector2d corner = aisle + ahead * along;
  const auto at_height = [&](const Eigen::Vector2d& xy) {
    return Eigen::Vector3d(xy.x(), xy.y(), slot.height);
  };
  return Approach{at_height(aisle + std::max(3.0, run_up) * along),
                  at_height(corner + (radius + kStraightEnd) * along), at_height(corner),
                  at_height(slot.outline.center - RearAxleX(kOwnCarStyle) * inward)};
}

/// From where `before` ends, exactly and in line with it, on to `points`.
Route Continue(const Route& before, std::vector<Eigen::Vector3d> points, double radius) {
  points.insert(points.begin(), before.PointAt(before.Length()));
  return Route(points, radius);
}

bool Fits(const Place& place, const std::vector<Leg>& legs) {
  const CarOutline outline = OwnCarOutline();
  const DrivePath path(legs);
  for (size_t leg = 1; leg < legs.size(); ++leg) {
    for (double distance = 0; distance < legs[leg].route.Length(); distance += 0.15) {
      const PathPoint at = path.At(leg, distance);
      const Eigen::Vector2d ahead(std::cos(at.heading), std::sin(at.heading)),
          left(-ahead.y(), ahead.x());
      for (double x = outline.rear - kClearance; x < outline.front + kClearance + 0.1; x += 0.2) {
        for (const double y : {-outline.half_width - kClearance, outline.half_width + kClearance}) {
          const Eigen::Vector2d point = at.position + x * ahead + y * left;
          if (!place.is_drivable(place.ground.SheetAt(point, at.near_z), point)) return false;
        }
      }
    }
  }
  return true;
}

std::vector<Leg> LegsOf(const RoutePlan& plan, const Approach& approach, double radius,
                        bool leaves_again) {
  std::vector<Eigen::Vector3d> there(plan.waypoints.begin(), plan.waypoints.end() - 1);
  there.push_back(approach.straightens);
  there.push_back(approach.far_end);
  std::vector<Leg> legs = {{Route(there, plan.corner_radius), false}};
  legs.push_back({Continue(legs[0].route, {approach.corner, approach.parked}, radius), true});
  if (leaves_again)
    legs.push_back({Continue(legs[1].route, {approach.corner, approach.far_end}, radius), false});
  return legs;
}

/// The plan's own slot, and the free ones on its level, the next to its end first.
std::vector<ParkingSlot> Candidates(const Place& place, const RoutePlan& plan) {
  std::vector<ParkingSlot> candidates;
  const Eigen::Vector3d end = plan.waypoints.back();
  const auto distance = [&](const ParkingSlot& slot) {
    return (slot.outline.center - end.head<2>()).norm();
  };
  for (const ParkingSlot& slot : place.slots)
    if (!slot.is_occupied && !slot.is_blocked && std::abs(slot.height - end.z()) < 1.5 &&
        distance(slot) < 60)
      candidates.push_back(slot);
  std::sort(candidates.begin(), candidates.end(),
            [&](const ParkingSlot& a, const ParkingSlot& b) { return distance(a) < distance(b); });
  if (plan.slot) candidates.insert(candidates.begin(), *plan.slot);
  return candidates;
}

std::optional<std::vector<Leg>> PlanParkingIn(const ParkingSlot& slot, const Place& place,
                                              const RoutePlan& plan, bool leaves_again) {
  for (const double aside : {0.0, 0.6, 1.2, -0.5}) {
    for (const double radius : {5.2, 5.8, 6.5}) {
      const auto approach = ApproachTo(slot, plan, radius, aside);
      if (!approach) continue;
      std::vector<Leg> legs = LegsOf(plan, *approach, radius, leaves_again);
      if (DrivePath(legs).MinRadius() >= 5 && Fits(place, legs)) return legs;
    }
  }
  return std::nullopt;
}

}  // namespace

CarOutline OwnCarOutline() {
  constexpr double kLength = 3.95;  // [m] of the hatchback
  const double middle = -RearAxleX(kOwnCarStyle);
  return {.front = middle + kLength / 2, .rear = middle - kLength / 2};
}

std::optional<std::vector<Leg>> PlanParking(const Place& place, const RoutePlan& plan,
                                            bool leaves_again) {
  if (plan.waypoints.size() < 3) return std::nullopt;
  for (const ParkingSlot& slot : Candidates(place, plan))
    if (auto legs = PlanParkingIn(slot, place, plan, leaves_again)) return legs;
  return std::nullopt;
}

}  // namespace parkade::simulator
