#include "tests/simulator/layouts/street_layout.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/simulator/common/random.h"
#include "tests/simulator/motion/route.h"
#include "tests/simulator/motion/terrain.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;

/// The middle of the street around, corners rounded, in steps of a meter.
RoadField::Line RoundTrip(const std::vector<Vector2d>& corners) {
  std::vector<Eigen::Vector3d> waypoints;
  const auto add = [&](const Vector2d& point) { waypoints.emplace_back(point.x(), point.y(), 0); };
  const Vector2d middle = (corners[0] + corners[1]) / 2;
  add(middle);
  for (size_t i = 1; i <= corners.size(); ++i) add(corners[i % corners.size()]);
  add(middle);
  const Route route(waypoints, StreetLayout::kCornerRadius);
  RoadField::Line line;
  for (double s = 0; s < route.Length(); s += 1) line.push_back(route.Position(s));
  line.push_back(middle);
  return line;
}

/// Parallel slots along both kerbs where the street is straight and no other is near.
void PlaceSlots(StreetLayout& street) {
  constexpr double kSlot = 6.2, kFree = 15;  // [m]
  for (const RoadField::Line* line : {&street.loop, &street.cross}) {
    for (const double side : {-1.0, 1.0}) {
      double place = 4;
      while (place + kSlot < static_cast<double>(line->size())) {
        const auto at = [&](double along) { return (*line)[static_cast<size_t>(along)]; };
        const Vector2d along = (at(place + kSlot - 1) - at(place)).normalized(),
                       left(-along.y(), along.x());
        const Vector2d center =
            (at(place) + at(place + kSlot - 1)) / 2 + side * StreetLayout::kParking * left;
        const Rectangle slot{
            center, {kSlot / 2, 1.0}, std::atan2(along.y(), along.x()) + (side > 0 ? M_PI : 0)};
        // Nobody parks in a bend or right beside one.
        const double last = static_cast<double>(line->size()) - 2;
        const Vector2d before = at(std::max(0.0, place - 7)),
                       beyond = at(std::min(last, place + kSlot + 7));
        const Vector2d head = (at(place) - before).normalized(),
                       tail = (beyond - at(place + kSlot - 1)).normalized();
        const bool is_straight = head.dot(along) > 0.999 && tail.dot(along) > 0.999;
        bool is_free = is_straight && (center - street.south_junction).norm() > kFree &&
                       (center - street.north_junction).norm() > kFree;
        for (int corner = 0; corner < 4; ++corner)
          is_free = is_free && street.field.At(slot.Corner(corner)) < 0.1;
        for (const double end : {-0.5, 0.5})
          is_free = is_free && std::abs(street.field.At(center + end * kSlot * along) + 1) < 0.2;
        for (const Rectangle& crossing : street.crossings)
          is_free = is_free && (crossing.center - center).norm() > 9;
        if (is_free) street.slots.push_back(slot);
        place += is_free ? kSlot : 1.5;
      }
    }
  }
}

void ParkCars(StreetLayout& street, Random& random) {
  const double length[] = {3.95, 4.6, 4.75}, width[] = {1.74, 1.82, 1.92};
  for (const Rectangle& slot : street.slots) {
    const double style_draw = random.Uniform();
    ParkedCar car;
    car.style = style_draw < 0.45 ? 0 : style_draw < 0.8 ? 1 : 2;
    car.seed = random.Bits();
    car.footprint.half_size = {length[car.style] / 2, width[car.style] / 2};
    car.footprint.yaw = slot.yaw + random.Uniform(-0.03, 0.03);
    const Vector2d along(std::cos(slot.yaw), std::sin(slot.yaw)), left(-along.y(), along.x());
    car.footprint.center =
        slot.center + random.Uniform(-0.5, 0.5) * along + random.Uniform(-0.1, 0.12) * left;
    if (random.Chance(0.68)) street.cars.push_back(car);
  }
}

void PlaceCrossings(StreetLayout& street) {
  for (const double share : {0.06, 0.3, 0.52, 0.78}) {
    const size_t index = static_cast<size_t>(share * static_cast<double>(street.loop.size()));
    const Vector2d along = (street.loop[index + 3] - street.loop[index - 3]).normalized();
    street.crossings.push_back(
        {street.loop[index], {1.6, StreetLayout::kHalfWidth}, std::atan2(along.y(), along.x())});
  }
}

}  // namespace

StreetLayout PlanStreet(std::uint64_t seed, int day) {
  Random random(seed, 0x57ee7);
  StreetLayout street;
  for (const auto& [x, y] :
       {std::pair(0.0, 0.0), {228.0, -8.0}, {242.0, 108.0}, {120.0, 132.0}, {-8.0, 104.0}})
    street.corners.emplace_back(x + random.Uniform(-7, 7), y + random.Uniform(-7, 7));
  street.loop = RoundTrip(street.corners);
  const auto on_side = [&](size_t side, double share) -> Vector2d {
    return street.corners[side] * (1 - share) +
           street.corners[(side + 1) % street.corners.size()] * share;
  };
  street.south_junction = on_side(0, random.Uniform(0.45, 0.5));
  street.north_junction = on_side(3, random.Uniform(0.3, 0.4));
  const Vector2d across = street.north_junction - street.south_junction;
  const int num_steps = static_cast<int>(across.norm());
  // The ends stay clear of the far kerbs, which they must not bend.
  for (int i = 5; i <= num_steps - 5; ++i)
    street.cross.push_back(street.south_junction + across * i / num_steps);
  street.field = RoadField({street.loop, street.cross}, StreetLayout::kHalfWidth, 40);
  for (int i = 0; i < 3; ++i) {
    const double wavelength = random.Uniform(150, 240), direction = random.Uniform(0, 2 * M_PI);
    street.hills.push_back(
        {2 * M_PI / wavelength * Vector2d(std::cos(direction), std::sin(direction)),
         random.Uniform(0.9, 1.7), random.Uniform(0, 2 * M_PI)});
  }
  PlaceCrossings(street);
  PlaceSlots(street);
  Random parking(seed, 0x57ee7000 + static_cast<std::uint64_t>(day));
  ParkCars(street, parking);
  return street;
}

}  // namespace parkade::simulator
