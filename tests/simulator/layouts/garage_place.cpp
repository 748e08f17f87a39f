#include "tests/simulator/layouts/garage_place.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "tests/simulator/layouts/garage_route.h"

namespace parkade::simulator {

using Eigen::Vector2d;

namespace {

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
                            return xy.y() <= layout->width || xy.x() <= layout->ramp_from ||
                                   xy.x() >= layout->ramp_to;
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
                            return deck * layout->storey +
                                   layout->straight.Height(xy.x() - layout->ramp_from);
                          },
                      .covers = {}});
  const double reach = layout->curve_radius + GarageLayout::kCurveHalfWidth;
  for (int deck = 0; deck < layout->num_ramps(); ++deck)
    sheets.push_back(
        {.min = {length, layout->curve_y - reach},
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

Place MakeGaragePlace(const GarageLayout& layout_in, const SceneOptions&) {
  const auto layout = std::make_shared<const GarageLayout>(layout_in);
  Place place;
  place.name = "garage";
  place.ground = MakeGround(layout);
  for (int deck = 0; deck < layout->num_decks(); ++deck) {
    const LotLayout& lot = layout->decks[static_cast<size_t>(deck)];
    for (const Rectangle& outline : lot.slots) {
      const auto stands_in = [&](const ParkedCar& car) {
        return outline.Contains(car.footprint.center);
      };
      place.slots.push_back(
          {.outline = outline,
           .height = deck * layout->storey,
           .is_occupied = std::any_of(lot.cars.begin(), lot.cars.end(), stands_in)});
    }
  }
  place.is_drivable = [layout](size_t sheet, const Vector2d& xy) {
    if (layout->IsUnderWall(sheet, xy)) return false;
    const auto is_free_of = [&](const std::vector<Rectangle>& solids) {
      return std::none_of(solids.begin(), solids.end(),
                          [&](const Rectangle& solid) { return solid.Contains(xy); });
    };
    if (sheet == layout->ForecourtSheet()) return is_free_of(layout->lamp_feet);
    if (sheet >= layout->decks.size()) return true;
    return (xy.y() >= layout->width || layout->decks[sheet].IsDrivable(xy)) &&
           is_free_of(layout->pillars) && is_free_of(layout->cores) &&
           is_free_of(layout->median_walls);
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
        place.walks.push_back(WalkAround({11, y + side}, {layout->length - 11, y + side}, 0.35,
                                         place.ground, 0, deck * layout->storey));
  place.plan_route = [layout, slots = place.slots](const RouteWish& wish) {
    return PlanGarageRoute(*layout, slots, wish);
  };
  return place;
}

}  // namespace parkade::simulator
