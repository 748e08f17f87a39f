#include "tests/simulator/layouts/street_route.h"

#include <algorithm>
#include <cmath>

#include "tests/simulator/motion/route.h"
#include "tests/simulator/motion/waypoint_trail.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;
using Corners = std::vector<Vector2d>;

/// A directed line of the plane.
struct Lane {
  Vector2d point, along;
};

/// The right-hand lane of the way from one point to another.
Lane RightLane(const Vector2d& from, const Vector2d& to) {
  const Vector2d along = (to - from).normalized();
  return {from + StreetLayout::kLane * Vector2d(along.y(), -along.x()), along};
}

Vector2d Meet(const Lane& first, const Lane& second) {
  const double cross = first.along.x() * second.along.y() - first.along.y() * second.along.x();
  const Vector2d offset = second.point - first.point;
  return first.point +
         first.along * ((offset.x() * second.along.y() - offset.y() * second.along.x()) / cross);
}

Lane LaneOfSide(const StreetLayout& layout, size_t side, bool is_clockwise) {
  const Vector2d &from = layout.corners[side],
                 &to = layout.corners[(side + 1) % layout.corners.size()];
  return is_clockwise ? RightLane(to, from) : RightLane(from, to);
}

/// A turn from one lane into another, tight: points before, in and after the corner.
void AddTurn(const Lane& from, const Lane& to, Corners& corners) {
  constexpr double kRoom = 13;  // [m]
  const Vector2d corner = Meet(from, to);
  corners.push_back(corner - kRoom * from.along);
  corners.push_back(corner);
  corners.push_back(corner + kRoom * to.along);
}

/// From the start to where the street across has been left the other way around.
Corners TurnAround(const StreetLayout& layout, bool is_clockwise) {
  const Lane down = RightLane(layout.north_junction, layout.south_junction);
  Corners corners = LaneCorners(layout, is_clockwise);
  corners.resize(is_clockwise ? 2 : 3);
  AddTurn(LaneOfSide(layout, 3, is_clockwise), down, corners);
  AddTurn(down, LaneOfSide(layout, 0, !is_clockwise), corners);
  return corners;
}

/// The part of a way up to about `length` [m]; it does not end in a corner.
std::vector<Eigen::Vector3d> FirstPart(const std::vector<Eigen::Vector3d>& points, double length) {
  constexpr double kLeast = 25;  // [m] of its last side
  std::vector<Eigen::Vector3d> part = {points.front()};
  for (size_t i = 1; i < points.size() && (length > kLeast || part.size() < 2); ++i) {
    const double side = (points[i] - points[i - 1]).norm();
    part.push_back(points[i - 1] +
                   (points[i] - points[i - 1]) * std::min(1.0, std::max(length, kLeast) / side));
    length -= side;
  }
  return part;
}

}  // namespace

std::vector<Vector2d> LaneCorners(const StreetLayout& layout, bool is_clockwise) {
  const size_t count = layout.corners.size();
  Corners corners;
  for (size_t i = 0; i < count; ++i) {
    const size_t side = is_clockwise ? (count - i) % count : i;
    const size_t next = is_clockwise ? (side + count - 1) % count : (side + 1) % count;
    corners.push_back(
        Meet(LaneOfSide(layout, side, is_clockwise), LaneOfSide(layout, next, is_clockwise)));
  }
  return corners;
}

RoutePlan PlanStreetRoute(const StreetLayout& layout, const RouteWish& wish) {
  const Vector2d along = (layout.corners[1] - layout.corners[0]).normalized();
  const auto start_of = [&](bool is_clockwise) -> Vector2d {
    const Lane lane = LaneOfSide(layout, 0, is_clockwise);
    return lane.point + lane.along * lane.along.dot(layout.corners[0] + 70 * along - lane.point);
  };
  const double round = static_cast<double>(layout.loop.size());
  // Turning around is most of a round; to the counter-clockwise it ends beyond the start, and a
  // round must follow.
  const double turn_around = wish.turns_around ? 0.85 * round : 0;
  const int least = wish.turns_around && !wish.is_reversed ? 0 : 1;
  const int num_rounds =
      std::max(least, static_cast<int>(std::lround((wish.length - turn_around) / round)));
  bool is_clockwise = wish.is_reversed;
  const Vector2d start = start_of(is_clockwise);
  WaypointTrail trail({start.x(), start.y(), 0}, wish.seed);
  const auto drive = [&](const Corners& corners) {
    for (const Vector2d& corner : corners) {
      const bool is_long = (corner - trail.nominal().head<2>()).norm() > 40;
      trail.DriveTo({corner.x(), corner.y(), 0}, is_long ? 0.25 : 0, 0);
    }
  };
  const int num_before = wish.turns_around ? (num_rounds - least) / 2 : num_rounds;
  for (int i = 0; i < num_before; ++i) drive(LaneCorners(layout, is_clockwise));
  if (wish.turns_around) {
    drive(TurnAround(layout, is_clockwise));
    is_clockwise = !is_clockwise;
  }
  for (int i = num_before; i < num_rounds; ++i) drive(LaneCorners(layout, is_clockwise));
  const Vector2d end = start_of(is_clockwise) + (is_clockwise ? -3 : 3) * along;
  trail.DriveTo({end.x(), end.y(), 0}, 0, 0);
  RoutePlan plan{.waypoints = trail.Take(), .slot = {}};
  plan.corner_radius = StreetLayout::kCornerRadius +
                       (is_clockwise || wish.turns_around ? -1 : 1) * StreetLayout::kLane;
  if (!wish.turns_around && !wish.is_whole && wish.length < 0.8 * round)
    plan.waypoints = FirstPart(plan.waypoints, wish.length);
  return plan;
}

}  // namespace parkade::simulator
