#include <cmath>

#include "tests/simulator/scenes/garage_structure.h"

namespace parkade::simulator {

using Eigen::Vector2d;
using Eigen::Vector3d;

void GarageStructure::Rooms() {
  const double clear = layout_.storey - GarageLayout::kSlab;
  for (int deck = 0; deck < layout_.num_decks(); ++deck) {
    const double floor = deck * layout_.storey;
    for (const Rectangle& core : layout_.cores) Room(core, floor);
    for (const Rectangle& wall : layout_.median_walls)
      Wall(wall.center - Vector2d(wall.half_size.x(), 0),
           wall.center + Vector2d(wall.half_size.x(), 0), floor,
           floor + std::min(layout_.median_wall, clear));
  }
}

/// With a door, a sign over it and what hangs beside it, on the side of the aisle.
void GarageStructure::Room(const Rectangle& core, double floor) {
  const double top = floor + layout_.storey - GarageLayout::kSlab;
  for (int corner = 0; corner < 4; ++corner)
    Wall(core.Corner(corner), core.Corner((corner + 1) % 4), floor, top);
  const double out = core.center.y() < layout_.width / 2 ? 1 : -1, yaw = out * M_PI / 2;
  const Vector3d face(core.center.x(), core.center.y() + out * (core.half_size.y() + 0.11), floor);
  mesh_.AddBox(face + Vector3d(0, 0, 1.05), {0.03, 0.55, 1.05}, yaw, metal_);
  mesh_.AddBox(face + Vector3d(0, 0, 1.0), {0.04, 0.45, 0.98}, yaw,
               layout_.style.has_bays_named ? red_ : paint_);
  mesh_.AddBox(face + Vector3d(0.3, 0, 1.05), {0.08, 0.07, 0.02}, yaw, metal_);
  ExitSign(face + Vector3d(0, 0, 2.28), yaw);
  const double beside = core.half_size.x() - 0.9;
  for (const double side : {-1.0, 1.0}) Poster(face + Vector3d(side * beside, 0, 1.55), yaw);
}

/// A board with the bay's number, as bars, on both sides along the aisle.
void GarageStructure::BayBoard(const Rectangle& pillar, double floor, int number) {
  for (const double side : {-1.0, 1.0}) {
    const Vector3d at(pillar.center.x() + side * (pillar.half_size.x() + 0.01), pillar.center.y(),
                      floor + 1.75);
    mesh_.AddBox(at, {0.012, 0.14, 0.2}, 0, paper_);
    for (int bar = 0; bar < 5; ++bar)
      if ((number + 3) >> bar & 1)
        mesh_.AddBox(at + Vector3d(0, side * 0.05 * (bar - 2), 0),
                     {0.016, 0.016, 0.06 + 0.02 * (number % 5)}, 0, black_);
  }
}

}  // namespace parkade::simulator
