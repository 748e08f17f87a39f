#include "tests/simulator/layouts/garage_route.h"

#include <algorithm>
#include <cmath>

#include "tests/simulator/motion/waypoint_trail.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector3d;
using Nodes = std::vector<Vector3d>;

constexpr double kGate = -22;  // [m] x where the forecourt is crossed

/// How a tour goes: to which deck, and how often around it.
struct Tour {
  int top = 1, rounds = 0;
};

class GarageTours {
 public:
  explicit GarageTours(const GarageLayout& layout)
      : layout_(layout),
        south_(layout.decks[0].aisle_y[0]),
        north_(layout.decks[0].aisle_y[1]),
        strip_(layout.width + GarageLayout::kStrip / 2),
        west_(4),
        east_(layout.length - 4) {}

  Vector3d Start() const { return {-12, south_, 0}; }

  /// From the start, heading into the building, back to behind the start.
  Nodes Forward(const Tour& tour) const {
    Nodes nodes;
    for (int deck = 0; deck < tour.top; ++deck) {
      AddCurve(deck, nodes);
      nodes.push_back({west_, north_, Z(deck + 1)});
      nodes.push_back({west_, south_, Z(deck + 1)});
    }
    for (int round = 0; round < tour.rounds; ++round)
      for (const auto& [x, y] :
           {std::pair(east_, south_), {east_, north_}, {west_, north_}, {west_, south_}})
        nodes.push_back({x, y, Z(tour.top)});
    for (int deck = tour.top; deck > 0; --deck) {
      nodes.push_back({east_, south_, Z(deck)});
      nodes.push_back({east_, strip_, Z(deck)});
      nodes.push_back({west_, strip_, Z(deck - 1)});
      if (deck > 1) nodes.push_back({west_, south_, Z(deck - 1)});
    }
    nodes.push_back({west_, north_, 0});
    nodes.push_back({kGate, north_, 0});
    nodes.push_back({kGate, south_, 0});
    return nodes;
  }

  /// From the start into the building and, through the lane across the middle, out again.
  Nodes TurnAround(bool is_reversed) const {
    const double cross = layout_.decks[0].short_loop[1].x();
    if (is_reversed)
      return {{kGate, south_, 0}, {kGate, north_, 0}, {cross, north_, 0}, {cross, south_, 0},
              {east_, south_, 0}, {east_, north_, 0}, {west_, north_, 0}, {west_, south_, 0}};
    return {{east_, south_, 0}, {east_, north_, 0}, {cross, north_, 0}, {cross, south_, 0}};
  }

  double Length(const Tour& tour) const {
    constexpr double kCut = 2.7;  // [m] that a rounded corner is shorter
    const Nodes nodes = Forward(tour);
    double length = (nodes.front() - Start()).norm() + (nodes.back() - Start()).norm();
    for (size_t i = 1; i < nodes.size(); ++i) {
      const double side = (nodes[i] - nodes[i - 1]).head<2>().norm();
      length += side > 4 ? side - kCut : side;
    }
    return length;
  }

 private:
  double Z(int deck) const { return deck * layout_.storey; }

  /// The half circle from `deck` up: a polygon around it, whose bends become one arc.
  void AddCurve(int deck, Nodes& nodes) const {
    constexpr int kBends = 9;
    const double radius = layout_.curve_radius / std::cos(M_PI / kBends / 2);
    for (int i = 0; i < kBends; ++i) {
      const double angle = M_PI * (i + 0.5) / kBends;
      nodes.push_back({layout_.length + radius * std::sin(angle),
                       layout_.curve_y - radius * std::cos(angle),
                       Z(deck) + layout_.storey * (i + 0.5) / kBends});
    }
  }

  const GarageLayout& layout_;
  double south_, north_, strip_, west_, east_;
};

/// The tours that come closest to a length; one at least.
std::vector<Tour> ChooseTours(const GarageTours& tours, int num_ramps, double length) {
  constexpr double kPreferred = 60;  // [m] of miss that a higher tour may have
  std::vector<Tour> best;
  double best_miss = 1e9;
  for (int top = 1; top <= num_ramps; ++top) {
    for (int rounds = 0; rounds <= 2; ++rounds) {
      const double one = tours.Length({top, rounds});
      const size_t count = static_cast<size_t>(std::max(1L, std::lround(length / one)));
      const double miss =
          std::abs(static_cast<double>(count) * one - length) + 2 * rounds - kPreferred * top;
      if (miss >= best_miss) continue;
      best_miss = miss;
      best.assign(count, {top, rounds});
    }
  }
  return best;
}

std::optional<ParkingSlot> ChooseSlot(const std::vector<ParkingSlot>& slots, double aisle_y) {
  for (const ParkingSlot& slot : slots)
    if (!slot.is_occupied && slot.height < 0.1 && std::abs(slot.outline.center.y() - aisle_y) < 7)
      return slot;
  return std::nullopt;
}

}  // namespace

RoutePlan PlanGarageRoute(const GarageLayout& layout, const std::vector<ParkingSlot>& slots,
                          const RouteWish& wish) {
  const GarageTours tours(layout);
  const double turn_around = wish.turns_around ? 2 * layout.length + 60 : 0;
  const std::vector<Tour> chosen =
      ChooseTours(tours, layout.num_ramps(), wish.length - turn_around);
  WaypointTrail trail(tours.Start(), wish.seed);
  bool is_reversed = wish.is_reversed != layout.is_counter;
  const auto drive = [&](const Nodes& nodes) {
    for (const Vector3d& node : nodes) {
      const Eigen::Vector2d side = (node - trail.nominal()).head<2>();
      // Swings only along the aisles of one deck, and not into the half circles.
      const bool is_aisle =
          std::abs(side.y()) < 0.1 && std::abs(node.z() - trail.nominal().z()) < 0.1;
      trail.DriveTo(node, is_aisle ? 0.5 : 0, is_aisle ? 0.2 : 0);
    }
  };
  for (size_t i = 0; i < chosen.size(); ++i) {
    if (wish.turns_around && i == chosen.size() / 2) {
      drive(tours.TurnAround(is_reversed));
      is_reversed = !is_reversed;
    }
    Nodes nodes = tours.Forward(chosen[i]);
    if (is_reversed) std::reverse(nodes.begin(), nodes.end());
    drive(nodes);
  }
  const Vector3d end = tours.Start() + Vector3d(is_reversed ? -3 : 3, 0, 0);
  trail.DriveTo(end, 0, 0);
  // Between walls people are careful: 2.8 m/s around a pillar, 3.4 m/s up a half circle.
  RoutePlan plan{.waypoints = trail.Take(),
                 .corner_radius = 5.4,
                 .max_lateral_acceleration = 1.45,
                 .slot = {}};
  if (wish.ends_in_slot) plan.slot = ChooseSlot(slots, layout.decks[0].aisle_y[0]);
  return plan;
}

}  // namespace parkade::simulator
