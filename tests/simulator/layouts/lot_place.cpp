#include "tests/simulator/layouts/lot_place.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/simulator/common/random.h"
#include "tests/simulator/motion/route.h"
#include "tests/simulator/motion/terrain.h"
#include "tests/simulator/motion/waypoint_trail.h"

namespace parkade::simulator {
namespace {

using Corners = std::vector<Eigen::Vector2d>;

/// Which rounds a drive makes: the long ones first.
struct Rounds {
  int num_long = 0, num_short = 0;
};

Corners Round(const Corners& loop, bool is_reversed) {
  if (is_reversed) return {loop[0], loop[3], loop[2], loop[1]};
  return {loop[1], loop[2], loop[3], loop[0]};
}

/// From the middle of the first aisle to a little beyond it.
RoutePlan DriveRounds(const LotLayout& layout, const Rounds& rounds, const RouteWish& wish) {
  const Eigen::Vector2d start = 0.55 * layout.short_loop[0] + 0.45 * layout.short_loop[1];
  const Eigen::Vector2d ahead = (layout.short_loop[1] - layout.short_loop[0]).normalized();
  WaypointTrail trail({start.x(), start.y(), 0}, wish.seed);
  const auto drive = [&](const Corners& corners) {
    for (const Eigen::Vector2d& corner : corners) {
      const bool is_aisle = std::abs(corner.y() - trail.nominal().y()) < 1;
      trail.DriveTo({corner.x(), corner.y(), 0}, is_aisle ? 0.7 : 0, 0.3);
    }
  };
  bool is_reversed = wish.is_reversed;
  const int num_rounds = rounds.num_long + rounds.num_short;
  for (int round = 0; round < num_rounds; ++round) {
    if (wish.turns_around && round == num_rounds / 2) {
      // By the lane across the middle back into the first aisle, the other way.
      const Eigen::Vector2d &first = layout.short_loop[1], &second = layout.short_loop[2];
      if (is_reversed)
        // A long round brings it back to where all rounds begin.
        drive({layout.long_loop[0], layout.long_loop[3], second, first, layout.long_loop[1],
               layout.long_loop[2], layout.long_loop[3], layout.long_loop[0]});
      else
        drive({layout.long_loop[1], layout.long_loop[2], second, first});
      is_reversed = !is_reversed;
    }
    drive(Round(round < rounds.num_long ? layout.long_loop : layout.short_loop, is_reversed));
  }
  const Eigen::Vector2d end = start + (is_reversed ? -3.0 : 3.0) * ahead;
  trail.DriveTo({end.x(), end.y(), 0}, 0, 0);
  return {.waypoints = trail.Take(), .slot = {}};
}

double LengthOf(const RoutePlan& plan) {
  return Route(plan.waypoints, plan.corner_radius).Length();
}

/// The rounds that come closest to the length wished for; one short one when none does.
Rounds ChooseRounds(const LotLayout& layout, const RouteWish& wish) {
  const double nothing = wish.turns_around ? LengthOf(DriveRounds(layout, {0, 1}, wish)) : 0;
  RouteWish plain = wish;
  plain.turns_around = false;
  const double long_round = LengthOf(DriveRounds(layout, {1, 0}, plain)),
               short_round = LengthOf(DriveRounds(layout, {0, 1}, plain));
  const double wanted = std::max(0.0, wish.length - std::max(0.0, nothing - short_round));
  Rounds best{0, 1};
  double best_miss = std::abs(best.num_short * short_round - wanted);
  for (int num_long = 0; num_long * long_round < wanted + long_round; ++num_long) {
    const int num_short =
        std::max(0, static_cast<int>(std::lround((wanted - num_long * long_round) / short_round)));
    const double miss = std::abs(num_long * long_round + num_short * short_round - wanted);
    if (num_long + num_short == 0 || miss >= best_miss) continue;
    best = {num_long, num_short};
    best_miss = miss;
  }
  return best;
}

/// A free slot beside the first aisle, ahead of where the drive comes to its end; those
/// with free neighbors first.
std::optional<ParkingSlot> ChooseSlot(const std::vector<ParkingSlot>& slots,
                                      const RoutePlan& plan) {
  const Eigen::Vector2d end = plan.waypoints.back().head<2>();
  const ParkingSlot* best = nullptr;
  double best_cost = 1e9;
  for (const ParkingSlot& slot : slots) {
    if (slot.is_occupied || slot.is_blocked || std::abs(slot.outline.center.y() - end.y()) > 8)
      continue;
    double cost = std::abs(slot.outline.center.x() - end.x());
    for (const ParkingSlot& other : slots)
      if (other.is_occupied && (other.outline.center - slot.outline.center).norm() < 2.7) cost += 8;
    if (cost < best_cost) {
      best_cost = cost;
      best = &slot;
    }
  }
  return best ? std::optional(*best) : std::nullopt;
}

}  // namespace

Place MakeLotPlace(const LotLayout& layout_in, const SceneOptions& options) {
  const auto layout = std::make_shared<const LotLayout>(layout_in);
  const Terrain terrain(options.seed, options.relief);
  Place place;
  place.name = "lot";
  place.ground = Ground({{.min = Eigen::Vector2d::Zero(),
                          .max = Eigen::Vector2d(layout->length, layout->width),
                          .height =
                              [terrain, layout](const Eigen::Vector2d& xy) {
                                return terrain.Height(xy.x(), xy.y()) + BumpHeight(*layout, xy);
                              },
                          .covers = {}}});
  for (const Rectangle& outline : layout->slots) {
    const auto stands_in = [&](const ParkedCar& car) {
      return outline.Contains(car.footprint.center);
    };
    const auto lies_in = [&](const Rectangle& heap) { return outline.Contains(heap.center); };
    place.slots.push_back(
        {.outline = outline,
         .height = place.ground.Height(outline.center, 0),
         .is_occupied = std::any_of(layout->cars.begin(), layout->cars.end(), stands_in),
         .is_blocked = std::any_of(layout->heaps.begin(), layout->heaps.end(), lies_in)});
  }
  place.is_drivable = [layout](size_t, const Eigen::Vector2d& xy) {
    return layout->IsDrivable(xy);
  };
  place.is_covered = [](const Eigen::Vector3d&) { return false; };
  place.plan_route = [layout, slots = place.slots](const RouteWish& wish) {
    RoutePlan plan = DriveRounds(*layout, ChooseRounds(*layout, wish), wish);
    if (wish.ends_in_slot) plan.slot = ChooseSlot(slots, plan);
    return plan;
  };
  // People walk along the cars' ends and across the aisles.
  for (const double y : layout->aisle_y)
    for (const double side : {-2.75, 2.75})
      place.walks.push_back(
          WalkAround({10, y + side}, {layout->length - 10, y + side}, 0.35, place.ground, 0));
  for (const double share : {0.3, 0.55, 0.75})
    place.walks.push_back(WalkAround({share * layout->length, layout->aisle_y[0] - 3},
                                     {share * layout->length, layout->aisle_y[0] + 3}, 0.5,
                                     place.ground, 0));
  return place;
}

}  // namespace parkade::simulator
