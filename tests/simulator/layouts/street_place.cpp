#include "tests/simulator/layouts/street_place.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/simulator/layouts/street_route.h"
#include "tests/simulator/motion/route.h"
#include "tests/simulator/motion/terrain.h"

namespace parkade::simulator {

using Eigen::Vector2d;

Place MakeStreetPlace(const StreetLayout& layout_in, const SceneOptions& options) {
  const auto layout = std::make_shared<const StreetLayout>(layout_in);
  const Terrain terrain(options.seed, options.relief);
  Place place;
  place.name = "street";
  const double relief = options.relief;
  place.ground = Ground({{.min = layout->field.min(),
                          .max = layout->field.max(),
                          .height =
                              [terrain, layout, relief](const Vector2d& xy) {
                                double height = terrain.Height(xy.x(), xy.y());
                                for (const StreetLayout::Wave& hill : layout->hills)
                                  height += relief * hill.amplitude *
                                            std::sin(hill.wave_vector.dot(xy) + hill.phase);
                                return height;
                              },
                          .covers = {}}});
  for (const Rectangle& outline : layout->slots) {
    const auto stands_in = [&](const ParkedCar& car) {
      return outline.Contains(car.footprint.center);
    };
    place.slots.push_back(
        {.outline = outline,
         .height = place.ground.Height(outline.center, 0),
         .kind = "parallel",
         .is_occupied = std::any_of(layout->cars.begin(), layout->cars.end(), stands_in)});
  }
  place.is_drivable = [layout](size_t, const Vector2d& xy) {
    const auto covers = [&](const ParkedCar& car) { return car.footprint.Contains(xy); };
    return layout->field.At(xy) < 0 &&
           std::none_of(layout->cars.begin(), layout->cars.end(), covers);
  };
  place.is_covered = [](const Eigen::Vector3d&) { return false; };
  for (const bool is_clockwise : {false, true}) {
    std::vector<Eigen::Vector3d> lane, corners;
    for (const Vector2d& corner : LaneCorners(*layout, is_clockwise))
      corners.emplace_back(corner.x(), corner.y(), 0);
    corners.insert(corners.begin(), (corners.front() + corners.back()) / 2);
    corners.push_back(corners.front());
    const Route route(corners,
                      StreetLayout::kCornerRadius + (is_clockwise ? -1 : 1) * StreetLayout::kLane);
    for (double s = 0; s < route.Length(); s += 1) {
      const Vector2d at = route.Position(s);
      lane.emplace_back(at.x(), at.y(), place.ground.Height(at, 0));
    }
    place.lanes.push_back(std::move(lane));
  }
  for (size_t index = 10; index + 45 < layout->loop.size(); index += 50) {
    const Vector2d &from = layout->loop[index], &to = layout->loop[index + 35];
    const Vector2d along = (to - from).normalized(), left(-along.y(), along.x());
    for (const double side : {-7.2, 7.2}) {
      const Vector2d a = from + side * left, b = to + side * left;
      if (layout->field.At((a + b) / 2) > 1.2 && layout->field.At(a) > 1.2 &&
          layout->field.At(b) > 1.2)
        place.walks.push_back(WalkAround(a, b, 0.8, place.ground, 0.11));
    }
  }
  for (const Rectangle& crossing : layout->crossings) {
    const Vector2d across(-std::sin(crossing.yaw), std::cos(crossing.yaw));
    place.walks.push_back(WalkAround(crossing.center - 6.8 * across, crossing.center + 6.8 * across,
                                     0.9, place.ground, 0.02));
  }
  place.plan_route = [layout](const RouteWish& wish) { return PlanStreetRoute(*layout, wish); };
  return place;
}

}  // namespace parkade::simulator
