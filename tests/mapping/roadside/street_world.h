#pragma once

#include <vector>

#include "core/surface_map.h"
#include "mapping/ground/driven_path.h"

namespace parkade {

/// A street along x, 10 m wide between kerbs at y = 5 and y = -5, `length` [m] long from x = 0,
/// with cars at the kerb at y = -5, a car's length of 4.6 m and width of 1.8 m about each of `cars`
/// (x, [m]). Who drove along y = -1 saw the front half of each.
inline SurfaceMap StreetWithCars(double length, const std::vector<double>& cars) {
  constexpr double kSize = 0.1, kHeight = 0.2;
  SurfaceMap surface{kSize, {}};
  const auto add = [&](int x, int y, SurfaceClass seen) {
    SurfaceCell cell{.x = x, .y = y, .height = static_cast<float>(kHeight)};
    cell.free_belief = IsForCars(seen) ? 1 : 0;
    cell.class_beliefs[static_cast<std::size_t>(seen)] = 255;
    surface.cells.push_back(cell);
  };
  for (int row = -55; row < 55; ++row)
    for (int column = 0; column * kSize < length; ++column) {
      const double x = (column + 0.5) * kSize, y = (row + 0.5) * kSize;
      bool is_car = false;
      for (const double car : cars)
        is_car = is_car || (std::abs(x - car) < 2.3 && y > -4.9 && y < -3.1);
      if (is_car && y < -4) continue;  // hidden
      const SurfaceClass seen = is_car            ? SurfaceClass::kVehicle
                                : std::abs(y) > 5 ? SurfaceClass::kKerb
                                                  : SurfaceClass::kDrivable;
      add(column, row, seen);
    }
  return surface;
}

/// Along y = -1 from x = 8 to x = `end` [m], the body's origin half a meter above the ground.
inline DrivenPath PathAlongStreet(double end) {
  std::vector<TrajectoryState> states;
  for (double x = 8; x <= end; x += 1) {
    TrajectoryState state;
    state.time.ns = static_cast<std::int64_t>(states.size() + 1) * 200'000'000;
    state.world_from_body.translation = {x, -1, 0.7};
    states.push_back(state);
  }
  DrivenPath path;
  path.site_from_body = Trajectory(std::move(states));
  return path;
}

}  // namespace parkade
