#include "tests/simulator/lot_layout.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/simulator/random.h"

namespace parkade::simulator {
namespace {

constexpr double kSlotWidth = 2.5, kSlotDepth = 5.0, kAisle = 6.5, kLane = 8.0, kIsland = 1.6, kMargin = 0.3;

constexpr int kCrossLaneSlots = 4;  // the lane across the middle takes the room of these

/// One row of slots; `yaw` points from the aisle into the slot.
void AddRow(LotLayout& lot, double center_y, double yaw, int num_slots, bool has_cross_lane) {
  const int gap = (num_slots - kCrossLaneSlots) / 2;
  for (int i = 0; i < num_slots; ++i) {
    if (has_cross_lane && i >= gap && i < gap + kCrossLaneSlots) continue;
    const double x = kLane + kIsland + (i + 0.5) * kSlotWidth;
    lot.slots.push_back({{x, center_y}, {kSlotDepth / 2, kSlotWidth / 2}, yaw});
  }
}

/// Cars stand a little askew and off centre, nose or tail first. Whole stretches
/// stay empty, as in real lots.
void ParkCars(LotLayout& lot, Random& random) {
  const double fill_phase = random.Uniform(0, 6), fill_period = random.Uniform(14, 22);
  for (const Rectangle& slot : lot.slots) {
    const double crowd = std::sin(2 * M_PI * slot.center.x() / fill_period + fill_phase + slot.center.y());
    const double style_draw = random.Uniform();
    ParkedCar car;
    car.style = style_draw < 0.45 ? 0 : style_draw < 0.8 ? 1 : 2;
    car.seed = random.Bits();
    const double length[] = {3.95, 4.6, 4.75}, width[] = {1.74, 1.82, 1.92};
    car.footprint.half_size = {length[car.style] / 2, width[car.style] / 2};
    car.footprint.yaw = slot.yaw + random.Uniform(-0.045, 0.045) + (random.Chance(0.3) ? M_PI : 0);
    car.footprint.center =
        slot.center + Eigen::Vector2d(random.Uniform(-0.14, 0.14), std::sin(slot.yaw) * random.Uniform(-0.12, 0.14));
    if (random.Uniform() < 0.52 + 0.38 * crowd) lot.cars.push_back(car);
  }
}

}  // namespace

bool LotLayout::IsDrivable(const Eigen::Vector2d& point) const {
  if (point.x() < 0 || point.y() < 0 || point.x() > length || point.y() > width) return false;
  const auto covers = [&](const Rectangle& rectangle) { return rectangle.Contains(point); };
  return std::none_of(islands.begin(), islands.end(), covers) &&
         std::none_of(cars.begin(), cars.end(), [&](const ParkedCar& car) { return covers(car.footprint); });
}

double BumpHeight(const LotLayout& lot, const Eigen::Vector2d& point) {
  constexpr double kHeight = 0.06, kHalfLength = 2.0, kHalfWidth = 4.5;  // [m]; it fades out in the slots
  double height = 0;
  for (const Eigen::Vector2d& bump : lot.bumps) {
    const double u = (point.x() - bump.x()) / kHalfLength, v = (point.y() - bump.y()) / kHalfWidth;
    if (std::abs(u) >= 1 || std::abs(v) >= 1) continue;
    const double along = 1 - u * u, across = 1 - v * v * v * v;
    height += kHeight * along * along * along * across * across * across;
  }
  return height;
}

void AddBumps(int count, LotLayout& lot) {
  const std::array<double, 4> places = {0.38, 0.73, 0.73, 0.38};
  for (int i = 0; i < std::min(count, 4); ++i)
    lot.bumps.emplace_back(places[static_cast<size_t>(i)] * lot.length, lot.aisle_y[i % 2]);
}

LotLayout PlanLot(std::uint64_t seed, int day) {
  Random random(seed, 0x107);
  const int num_slots = 15 + random.Index(4);
  LotLayout lot;
  lot.length = 2 * (kLane + kIsland) + num_slots * kSlotWidth;
  lot.width = 2 * kMargin + 4 * kSlotDepth + 2 * kAisle;
  const double up = M_PI / 2;
  AddRow(lot, kMargin + 0.5 * kSlotDepth, -up, num_slots, false);
  AddRow(lot, kMargin + 1.5 * kSlotDepth + kAisle, up, num_slots, true);
  AddRow(lot, kMargin + 2.5 * kSlotDepth + kAisle, -up, num_slots, true);
  AddRow(lot, kMargin + 3.5 * kSlotDepth + 2 * kAisle, up, num_slots, false);
  ParkCars(lot, random);
  if (day > 0) {
    lot.cars.clear();
    Random other(seed, 0x107000 + static_cast<std::uint64_t>(day));
    ParkCars(lot, other);
  }

  const double middle = lot.width / 2, island_half = kSlotDepth - 0.4;
  const double cross_x = kLane + kIsland + kSlotWidth * ((num_slots - kCrossLaneSlots) / 2 + kCrossLaneSlots / 2.0);
  const double cross_half = kCrossLaneSlots * kSlotWidth / 2 - kIsland / 2;
  for (const double x :
       {kLane + kIsland / 2, cross_x - cross_half, cross_x + cross_half, lot.length - kLane - kIsland / 2})
    lot.islands.push_back({{x, middle}, {kIsland / 2 - 0.15, island_half}, 0});
  for (const double x : {1.3, lot.length - 1.3})
    for (const double y : {1.2, lot.width - 1.2}) lot.islands.push_back({{x, y}, {1.3, 1.2}, 0});

  lot.aisle_y[0] = kMargin + kSlotDepth + kAisle / 2;
  lot.aisle_y[1] = lot.width - lot.aisle_y[0];
  const bool is_turned = random.Chance(0.5);
  const double first = lot.aisle_y[is_turned], second = lot.aisle_y[!is_turned];
  const auto loop_to = [&](double right) -> std::vector<Eigen::Vector2d> {
    return {{kLane / 2, first}, {right, first}, {right, second}, {kLane / 2, second}};
  };
  lot.long_loop = loop_to(lot.length - kLane / 2);
  lot.short_loop = loop_to(cross_x);
  return lot;
}

}  // namespace parkade::simulator
