#include "tests/simulator/layouts/lot_layout.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/simulator/common/random.h"
#include "tests/simulator/ground/season.h"

namespace parkade::simulator {
namespace {

constexpr double kLane = 8.0, kIsland = 1.6, kMargin = 0.3;
constexpr double kCrossLane =
    9.6;  // [m] between slots; the lane across the middle takes the room of as many as that

/// One row of slots: where, and how they stand.
struct Row {
  double center_y = 0;  ///< [m]
  double yaw = 0;       ///< [rad] from the aisle into the slots
  double pitch = 2.5;   ///< [m] from slot to slot
  int count = 0;
  int gap_begin = 0, gap_end = 0;  ///< slots that the lane across takes

  double Boundary(int slot) const { return kLane + kIsland + slot * pitch; }
};

void AddRow(const LotMeasures& measures, const Row& row, LotLayout& lot) {
  for (int i = 0; i < row.count; ++i) {
    if (i >= row.gap_begin && i < row.gap_end) continue;
    lot.slots.push_back({{row.Boundary(i) + row.pitch / 2, row.center_y},
                         {measures.slot_depth / 2, measures.slot_width / 2},
                         row.yaw});
  }
}

/// Cars stand a little askew and off center, nose or tail first. Whole stretches
/// stay empty, as in real lots.
void ParkCars(LotLayout& lot, Random& random) {
  const double fill_phase = random.Uniform(0, 6), fill_period = random.Uniform(14, 22);
  for (const Rectangle& slot : lot.slots) {
    const double crowd =
        std::sin(2 * M_PI * slot.center.x() / fill_period + fill_phase + slot.center.y());
    const double style_draw = random.Uniform();
    ParkedCar car;
    car.style = style_draw < 0.45 ? 0 : style_draw < 0.8 ? 1 : 2;
    car.seed = random.Bits();
    const double length[] = {3.95, 4.6, 4.75}, width[] = {1.74, 1.82, 1.92};
    car.footprint.half_size = {length[car.style] / 2, width[car.style] / 2};
    car.footprint.yaw = slot.yaw + random.Uniform(-0.045, 0.045) + (random.Chance(0.3) ? M_PI : 0);
    car.footprint.center =
        slot.center + Eigen::Vector2d(random.Uniform(-0.14, 0.14),
                                      std::sin(slot.yaw) * random.Uniform(-0.12, 0.14));
    if (random.Uniform() < 0.52 + 0.38 * crowd) lot.cars.push_back(car);
  }
}

}  // namespace

/// Whether a point lies in the ellipse that touches the sides of a rectangle.
bool InEllipse(const Rectangle& rectangle, const Eigen::Vector2d& point) {
  const Eigen::Vector2d local = Eigen::Rotation2Dd(-rectangle.yaw) * (point - rectangle.center);
  return local.cwiseQuotient(rectangle.half_size).squaredNorm() <= 1;
}

bool LotLayout::IsDrivable(const Eigen::Vector2d& point) const {
  if (point.x() < 0 || point.y() < 0 || point.x() > length || point.y() > width) return false;
  const auto covers = [&](const Rectangle& rectangle) { return rectangle.Contains(point); };
  return std::none_of(islands.begin(), islands.end(), covers) &&
         std::none_of(heaps.begin(), heaps.end(),
                      [&](const Rectangle& heap) { return InEllipse(heap, point); }) &&
         std::none_of(cars.begin(), cars.end(),
                      [&](const ParkedCar& car) { return covers(car.footprint); });
}

double LotLayout::FromKerb(const Eigen::Vector2d& point) const {
  double distance =
      std::min(std::min(point.x(), length - point.x()), std::min(point.y(), width - point.y()));
  for (const Rectangle& island : islands)
    distance = std::min(distance, island.SignedDistance(point));
  return distance;
}

double BumpHeight(const LotLayout& lot, const Eigen::Vector2d& point) {
  constexpr double kHeight = 0.06, kHalfLength = 2.0,
                   kHalfWidth = 4.5;  // [m]; it fades out in the slots
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

void AddHeaps(int count, std::uint64_t seed, int day, LotLayout& lot) {
  Random random(seed, 0x5e40 + static_cast<std::uint64_t>(day));
  std::vector<const Rectangle*> free;
  for (const Rectangle& slot : lot.slots)
    if (std::none_of(lot.cars.begin(), lot.cars.end(),
                     [&](const ParkedCar& car) { return slot.Contains(car.footprint.center); }))
      free.push_back(&slot);
  for (; count > 0 && !free.empty(); --count) {
    const auto chosen = free.begin() + random.Index(static_cast<int>(free.size()));
    Rectangle heap = **chosen;
    heap.half_size = {random.Uniform(0.8, 1.6), random.Uniform(0.6, 1.0)};
    // At the slot's back.
    heap.center += ((*chosen)->half_size.x() - heap.half_size.x()) *
                   Eigen::Vector2d(std::cos(heap.yaw), std::sin(heap.yaw));
    lot.heaps.push_back(heap);
    free.erase(chosen);
  }
}

LotMeasures MeasureLot(std::uint64_t seed) {
  Random random(seed, 0x3ea5);
  LotMeasures measures;
  measures.num_slots = 14 + random.Index(6);
  measures.slot_width = random.Uniform(2.42, 2.68);
  measures.slot_depth = random.Uniform(4.85, 5.3);
  measures.aisle = random.Uniform(6.3, 7.1);
  measures.cross_shift = random.Index(4) - 1;
  measures.is_turned = random.Chance(0.5);
  return measures;
}

LotLayout PlanLot(std::uint64_t seed, int day) { return PlanLot(MeasureLot(seed), seed, day); }

LotLayout PlanLot(const SceneOptions& options) {
  constexpr int kHeaps = 3;
  LotLayout lot = PlanLot(options.seed, options.day);
  AddBumps(options.speed_bumps, lot);
  if (SeasonOf(options.season) == Season::kWinter) AddHeaps(kHeaps, options.seed, options.day, lot);
  return lot;
}

LotLayout PlanLot(const LotMeasures& measures, std::uint64_t seed, int day) {
  const double depth = measures.slot_depth, slant = measures.slant, up = M_PI / 2;
  const double depth_inside =
      depth * std::cos(slant) + measures.slot_width * std::sin(std::abs(slant));
  LotLayout lot;
  lot.length = 2 * (kLane + kIsland) + measures.num_slots * measures.slot_width;
  lot.width = 2 * (kMargin + depth + measures.aisle + depth_inside) + measures.median;
  const Row outer{kMargin + depth / 2, -up, measures.slot_width, measures.num_slots};
  Row inner{kMargin + depth + measures.aisle + depth_inside / 2, up - slant,
            measures.slot_width / std::cos(slant)};
  inner.count = static_cast<int>(measures.num_slots * outer.pitch / inner.pitch + 1e-9);
  const int gap = static_cast<int>(std::ceil(kCrossLane / inner.pitch));
  inner.gap_begin = (inner.count - gap) / 2 + measures.cross_shift;
  inner.gap_end = inner.gap_begin + gap;
  AddRow(measures, outer, lot);
  AddRow(measures, inner, lot);
  // The northern half is the southern one turned around, but for the gap, which it has in common.
  inner.center_y = lot.width - inner.center_y, inner.yaw -= M_PI;
  AddRow(measures, inner, lot);
  AddRow(measures, {lot.width - outer.center_y, up, outer.pitch, outer.count}, lot);
  Random parking(seed, 0x107000 + static_cast<std::uint64_t>(day));
  ParkCars(lot, parking);

  const double middle = lot.width / 2, island_half = depth_inside - 0.4 + measures.median / 2;
  const double cross_x = (inner.Boundary(inner.gap_begin) + inner.Boundary(inner.gap_end)) / 2;
  const double cross_half = gap * inner.pitch / 2 - kIsland / 2;
  for (const double x : {kLane + kIsland / 2, cross_x - cross_half, cross_x + cross_half,
                         lot.length - kLane - kIsland / 2})
    lot.islands.push_back({{x, middle}, {kIsland / 2 - 0.15, island_half}, 0});
  for (const double x : {1.3, lot.length - 1.3})
    for (const double y : {1.2, lot.width - 1.2}) lot.islands.push_back({{x, y}, {1.3, 1.2}, 0});

  lot.aisle_y[0] = kMargin + depth + measures.aisle / 2;
  lot.aisle_y[1] = lot.width - lot.aisle_y[0];
  const double first = lot.aisle_y[measures.is_turned], second = lot.aisle_y[!measures.is_turned];
  const auto loop_to = [&](double right) -> std::vector<Eigen::Vector2d> {
    return {{kLane / 2, first}, {right, first}, {right, second}, {kLane / 2, second}};
  };
  lot.long_loop = loop_to(lot.length - kLane / 2);
  lot.short_loop = loop_to(cross_x);
  return lot;
}

}  // namespace parkade::simulator
