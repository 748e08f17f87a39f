#include "tests/simulator/garage_layout.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/simulator/garage_route.h"
#include "tests/simulator/random.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;

/// Between the slots of every third line, at the front of the slots.
std::vector<Rectangle> PlacePillars(const LotLayout& lot) {
  std::vector<Rectangle> pillars;
  for (size_t i = 0; i < lot.slots.size(); ++i) {
    const Rectangle& slot = lot.slots[i];
    const bool is_row_start = i == 0 || std::abs(lot.slots[i - 1].center.y() - slot.center.y()) > 1 ||
                              slot.center.x() - lot.slots[i - 1].center.x() > 3;
    const bool is_row_end = i + 1 == lot.slots.size() || std::abs(lot.slots[i + 1].center.y() - slot.center.y()) > 1 ||
                            lot.slots[i + 1].center.x() - slot.center.x() > 3;
    const Vector2d front = slot.center - 1.7 * Vector2d(std::cos(slot.yaw), std::sin(slot.yaw));
    if (is_row_start || i % 3 == 0) pillars.push_back({front - Vector2d(1.25, 0), {0.16, 0.35}, 0});
    if (is_row_end) pillars.push_back({front + Vector2d(1.25, 0), {0.16, 0.35}, 0});
  }
  return pillars;
}

Ground MakeGround(const std::shared_ptr<const GarageLayout>& layout) {
  std::vector<GroundSheet> sheets;
  const double length = layout->length, width = layout->width, north = width + GarageLayout::kStrip;
  for (int deck = 0; deck < layout->num_decks(); ++deck) {
    const double z = deck * layout->storey;
    sheets.push_back({.min = {0, 0},
                      .max = {length, north},
                      .height = [z](const Vector2d&) { return z; },
                      .covers =
                          [layout](const Vector2d& xy) {
                            return xy.y() <= layout->width || xy.x() <= layout->ramp_from || xy.x() >= layout->ramp_to;
                          }});
  }
  sheets.push_back({.min = {-GarageLayout::kForecourt, 0},
                    .max = {0, width},
                    .height = [](const Vector2d&) { return 0.0; },
                    .covers = {}});
  for (int deck = 0; deck < layout->num_ramps(); ++deck)
    sheets.push_back({.min = {layout->ramp_from, width},
                      .max = {layout->ramp_to, north},
                      .height =
                          [layout, deck](const Vector2d& xy) {
                            return deck * layout->storey + layout->straight.Height(xy.x() - layout->ramp_from);
                          },
                      .covers = {}});
  const double reach = layout->curve_radius + GarageLayout::kCurveHalfWidth;
  for (int deck = 0; deck < layout->num_ramps(); ++deck)
    sheets.push_back({.min = {length, layout->curve_y - reach},
                      .max = {length + reach, layout->curve_y + reach},
                      .height =
                          [layout, deck](const Vector2d& xy) {
                            const double angle = std::atan2(xy.y() - layout->curve_y, xy.x() - layout->length);
                            return deck * layout->storey +
                                   layout->curve.Height((angle + M_PI / 2) * layout->curve_radius);
                          },
                      .covers =
                          [layout](const Vector2d& xy) {
                            const double radius = (xy - Vector2d(layout->length, layout->curve_y)).norm();
                            return std::abs(radius - layout->curve_radius) <= GarageLayout::kCurveHalfWidth;
                          }});
  return Ground(std::move(sheets));
}

}  // namespace

GarageLayout PlanGarage(std::uint64_t seed, int day) {
  constexpr int kNumDecks = 3;
  GarageLayout garage;
  for (int deck = 0; deck < kNumDecks; ++deck) {
    LotLayout lot = PlanLot(seed, 1 + kNumDecks * day + deck);
    lot.islands.clear();
    if (lot.aisle_y[0] > lot.aisle_y[1]) std::swap(lot.aisle_y[0], lot.aisle_y[1]);
    for (auto* loop : {&lot.long_loop, &lot.short_loop})
      if ((*loop)[0].y() > (*loop)[2].y()) *loop = {(*loop)[3], (*loop)[2], (*loop)[1], (*loop)[0]};
    garage.decks.push_back(std::move(lot));
  }
  const LotLayout& lot = garage.decks.front();
  garage.length = lot.length;
  garage.width = lot.width;
  garage.pillars = PlacePillars(lot);
  garage.straight = {.rise = garage.storey, .run = 26.5, .transition = 5};
  garage.ramp_from = (lot.length - garage.straight.run) / 2;
  garage.ramp_to = garage.ramp_from + garage.straight.run;
  garage.curve_y = (lot.aisle_y[0] + lot.aisle_y[1]) / 2;
  garage.curve_radius = (lot.aisle_y[1] - lot.aisle_y[0]) / 2;
  garage.curve = {.rise = garage.storey, .run = M_PI * garage.curve_radius, .transition = 4};
  return garage;
}

Place MakeGaragePlace(const GarageLayout& layout_in, const SceneOptions&) {
  const auto layout = std::make_shared<const GarageLayout>(layout_in);
  Place place;
  place.name = "garage";
  place.ground = MakeGround(layout);
  for (int deck = 0; deck < layout->num_decks(); ++deck) {
    const LotLayout& lot = layout->decks[static_cast<size_t>(deck)];
    for (const Rectangle& outline : lot.slots) {
      const auto stands_in = [&](const ParkedCar& car) { return outline.Contains(car.footprint.center); };
      place.slots.push_back({.outline = outline,
                             .height = deck * layout->storey,
                             .is_occupied = std::any_of(lot.cars.begin(), lot.cars.end(), stands_in)});
    }
  }
  place.is_drivable = [layout](size_t sheet, const Vector2d& xy) {
    if (sheet >= layout->decks.size()) return true;
    const auto covers = [&](const Rectangle& pillar) { return pillar.Contains(xy); };
    return (xy.y() >= layout->width || layout->decks[sheet].IsDrivable(xy)) &&
           std::none_of(layout->pillars.begin(), layout->pillars.end(), covers);
  };
  place.is_covered = [layout](const Eigen::Vector3d& point) {
    const Vector2d from_curve = point.head<2>() - Vector2d(layout->length, layout->curve_y);
    const bool is_over_decks = point.x() >= 0 && point.x() <= layout->length && point.y() >= 0 &&
                               point.y() <= layout->width + GarageLayout::kStrip;
    return is_over_decks || (from_curve.x() > 0 && from_curve.norm() < layout->curve_radius + 2.8);
  };
  for (int deck = 0; deck < layout->num_decks(); ++deck)
    for (const double y : layout->decks[0].aisle_y)
      for (const double side : {-2.75, 2.75})
        place.walks.push_back(
            WalkAround({11, y + side}, {layout->length - 11, y + side}, 0.35, place.ground, 0, deck * layout->storey));
  place.plan_route = [layout, slots = place.slots](const RouteWish& wish) {
    return PlanGarageRoute(*layout, slots, wish);
  };
  return place;
}

}  // namespace parkade::simulator
