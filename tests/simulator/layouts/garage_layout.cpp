#include "tests/simulator/layouts/garage_layout.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/simulator/common/random.h"
#include "tests/simulator/layouts/props.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;

/// Between the slots of every few lines, toward their fronts.
std::vector<Rectangle> PlacePillars(const LotLayout& lot, const GarageMeasures& measures) {
  constexpr double kRowBreak = 4;  // [m] from slot to slot
  std::vector<Rectangle> pillars;
  int index_in_row = 0;
  for (size_t i = 0; i < lot.slots.size(); ++i) {
    const Rectangle& slot = lot.slots[i];
    const auto is_apart = [&](const Rectangle& other) {
      return (other.center - slot.center).norm() > kRowBreak;
    };
    const bool is_row_start = i == 0 || is_apart(lot.slots[i - 1]);
    const bool is_row_end = i + 1 == lot.slots.size() || is_apart(lot.slots[i + 1]);
    index_in_row = is_row_start ? 0 : index_in_row + 1;
    const Vector2d into(std::cos(slot.yaw), std::sin(slot.yaw)),
        front = slot.center - measures.pillar_inset * into;
    const Vector2d to_next =
        (into.y() > 0 ? 1 : -1) * slot.half_size.y() * Vector2d(into.y(), -into.x());
    if (index_in_row % measures.slots_per_pillar == 0)
      pillars.push_back({front - to_next, measures.pillar_half, 0});
    if (is_row_end) pillars.push_back({front + to_next, measures.pillar_half, 0});
  }
  return pillars;
}

/// Rooms in the place of a few slots of the rows along the sides.
std::vector<Rectangle> PlaceCores(const LotLayout& lot, int num_in_row, std::uint64_t seed) {
  constexpr double kWall = 0.1;  // [m] half its thickness
  constexpr int kLeastFromEnd = 2;
  Random random(seed, 0xc03e);
  std::vector<Rectangle> cores;
  const int count = 1 + random.Index(3);
  for (int i = 0; i < count; ++i) {
    const bool is_north = random.Chance(0.5);
    const int size = 2 + random.Index(3),
              begin = kLeastFromEnd + random.Index(num_in_row - size - 2 * kLeastFromEnd);
    const size_t first = static_cast<size_t>(begin) +
                         (is_north ? lot.slots.size() - static_cast<size_t>(num_in_row) : 0);
    const Rectangle &one = lot.slots[first],
                    &other = lot.slots[first + static_cast<size_t>(size) - 1];
    const Vector2d half(size * one.half_size.y() - kWall, one.half_size.x() - kWall);
    const Rectangle core{(one.center + other.center) / 2, half, 0};
    const auto overlaps = [&](const Rectangle& placed) {
      return std::abs(placed.center.y() - core.center.y()) < 1 &&
             std::abs(placed.center.x() - core.center.x()) < placed.half_size.x() + half.x() + 0.1;
    };
    if (std::none_of(cores.begin(), cores.end(), overlaps)) cores.push_back(core);
  }
  return cores;
}

/// Between the islands of the lot that a deck is like.
std::vector<Rectangle> PlaceMedianWalls(const LotLayout& lot) {
  std::vector<Rectangle> walls;
  for (const size_t island : {size_t{0}, size_t{2}}) {
    const double from = lot.islands[island].center.x() + 1,
                 to = lot.islands[island + 1].center.x() - 1;
    walls.push_back({{(from + to) / 2, lot.width / 2}, {(to - from) / 2, 0.1}, 0});
  }
  return walls;
}

/// Takes slots, and the cars in them, from where rooms are.
void MakeRoom(const std::vector<Rectangle>& cores, LotLayout& deck) {
  const auto is_inside = [&](const Vector2d& place) {
    return std::any_of(cores.begin(), cores.end(),
                       [&](const Rectangle& core) { return core.Contains(place); });
  };
  std::erase_if(deck.slots, [&](const Rectangle& slot) { return is_inside(slot.center); });
  std::erase_if(deck.cars, [&](const ParkedCar& car) { return is_inside(car.footprint.center); });
}

}  // namespace

GarageLayout PlanGarage(std::uint64_t seed, int day) {
  constexpr int kNumDecks = 3;
  constexpr double kRampRun = 26.5 / 2.9;  // per rise
  constexpr double kEnds = 9.6;            // [m] of the strip beside the ramp, to drive around
  const GarageMeasures measures = MeasureGarage(seed);
  GarageLayout garage;
  for (int deck = 0; deck < kNumDecks; ++deck)
    garage.decks.push_back(PlanLot(measures.deck, seed, 1 + kNumDecks * day + deck));
  const LotLayout& lot = garage.decks.front();
  garage.cores = PlaceCores(lot, measures.deck.num_slots, seed);
  if (measures.median_wall > 0) garage.median_walls = PlaceMedianWalls(lot);
  for (LotLayout& deck : garage.decks) {
    deck.islands.clear();
    MakeRoom(garage.cores, deck);
  }
  garage.median_wall = measures.median_wall;
  garage.is_counter = measures.is_counter;
  garage.style = StyleOfGarage(seed);
  garage.storey = measures.storey;
  garage.length = lot.length;
  garage.width = lot.width;
  garage.pillars = PlacePillars(lot, measures);
  for (const double x : {-8.0, -20.0})
    garage.lamp_feet.push_back(
        {{x, garage.width / 2 - 2}, Vector2d::Constant(Props::kLampFoot), 0});
  garage.straight = {.rise = garage.storey, .run = kRampRun * garage.storey, .transition = 5};
  garage.ramp_from = kEnds + measures.ramp_share * (lot.length - garage.straight.run - 2 * kEnds);
  garage.ramp_to = garage.ramp_from + garage.straight.run;
  garage.curve_y = (lot.aisle_y[0] + lot.aisle_y[1]) / 2;
  garage.curve_radius = (lot.aisle_y[1] - lot.aisle_y[0]) / 2;
  garage.curve = {.rise = garage.storey, .run = M_PI * garage.curve_radius, .transition = 4};
  return garage;
}

bool GarageLayout::IsUnderWall(size_t sheet, const Vector2d& point) const {
  if (sheet >= CurveSheet(0)) return false;
  const double north = width + kStrip;
  const bool is_deck = sheet<decks.size(), is_ramp = sheet> ForecourtSheet();
  const auto is_at = [](double place, double wall) { return std::abs(place - wall) < kWallHalf; };
  const auto is_in_gate = [&](double aisle) { return std::abs(point.y() - aisle) < kGateHalf; };
  const auto& aisle = decks[0].aisle_y;
  if (!is_ramp && is_at(point.x(), 0)) {
    const bool is_ground_floor = sheet == 0 || !is_deck;
    return !is_ground_floor || !(is_in_gate(aisle[0]) || is_in_gate(aisle[1]));
  }
  if (is_deck && is_at(point.x(), length)) {
    const bool goes_up = sheet + 1 < decks.size() && is_in_gate(aisle[0]);
    const bool goes_down = sheet > 0 && is_in_gate(aisle[1]);
    return !goes_up && !goes_down;
  }
  if (is_deck && is_at(point.y(), 0)) return true;
  const bool is_at_strip =
      point.x() > kStripWallEnd && point.x() < length - kStripWallEnd && is_at(point.y(), width);
  const auto is_in_core = [&](const Rectangle& core) {
    return Rectangle{core.center, (core.half_size.array() + kWallHalf).matrix(), core.yaw}.Contains(
        point);
  };
  return (is_deck || is_ramp) && (is_at(point.y(), north) || is_at_strip ||
                                  (is_deck && std::any_of(cores.begin(), cores.end(), is_in_core)));
}

}  // namespace parkade::simulator
