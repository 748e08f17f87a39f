#include "tests/export/lanelet2/parking_example.h"

#include <string>

#include "tests/export/example_map.h"

namespace parkade {
namespace {

using Eigen::Vector2d;

/// A slot from the middle of its entrance inwards.
ParkingSlot MakeSlot(const Vector2d& entrance, const Vector2d& inwards, double entrance_length,
                     double height) {
  const Vector2d across = 0.5 * entrance_length * Vector2d(inwards.y(), -inwards.x()).normalized();
  const std::array<Vector2d, 4> corners = {entrance - across, entrance + across,
                                           entrance + across + inwards,
                                           entrance - across + inwards};
  ParkingSlot slot;
  for (size_t i = 0; i < 4; ++i) slot.corners[i] << corners[i], height + 0.01 * corners[i].y();
  slot.kind = slot.Depth() > slot.Entrance() ? SlotKind::kPerpendicular : SlotKind::kParallel;
  slot.angle = slot.kind == SlotKind::kParallel ? 0 : M_PI / 2;
  slot.num_marked_sides = 2;
  return slot;
}

void CloseGround(SurfaceMap& surface, const Vector2d& low, const Vector2d& high) {
  for (SurfaceCell& cell : surface.cells) {
    const Vector2d center = surface.cell_size * Vector2d(cell.x + 0.5, cell.y + 0.5);
    if (cell.height < 1 && (center - low).minCoeff() > 0 && (high - center).minCoeff() > 0)
      cell.free_belief = 0.1F;
  }
}

}  // namespace

SiteMap MakeParkingExample(bool is_georeferenced) {
  SiteMap map = MakeExampleMap(is_georeferenced);
  std::vector<ParkingSlot>& slots = map.markings.slots;
  for (int i = 0; i < 4; ++i)
    slots.push_back(MakeSlot({-15.013 + 2.5 * i, 3.9}, {0, i == 0 ? 5.6 : 5.0}, 2.5, 0));
  CloseGround(map.surface, {-8.4, 4.5}, {-6.6, 8.5});
  slots.push_back(MakeSlot({-2, -7.3}, {0, -2.2}, 6, 0));
  slots.push_back(MakeSlot({11, 0.5}, {0, 5}, 2.5, 0));
  slots.push_back(MakeSlot({11, 0.1}, {0, 5}, 2.5, kUpperDeckHeight - 0.1));
  CloseGround(map.surface, {-19, -8}, {-11, 0});
  slots.push_back(MakeSlot({-16, -6}, {2.4, 4.1}, 2.3, 0));
  slots.back().kind = SlotKind::kAngled;
  slots.push_back(MakeSlot({30, 0}, {5, 0}, 2.5, 0));
  for (ParkingSlot& slot : slots) {
    slot.id = "slot_" + std::to_string(&slot - slots.data());
    slot.states.assign(map.drives.size(), SlotState::kFree);
  }
  map.markings.kerbs = {
      {.points = {{19, 9, 0.09}, {-5, 9, 0.09}, {-19, 9, 0.09}},
       .height = 0.12,
       .height_sigma = 0.01},
      {.points = {{20, -14, 2.5}, {20, 10, 2.5}}, .height = 0.04, .height_sigma = 0.01}};
  return map;
}

ParkingMap ParkingMapOf(const SiteMap& map) {
  ParkingMap parking{.sheets = FindFreeSheets(map.surface),
                     .cell_size = map.surface.cell_size,
                     .kerbs = map.markings.kerbs};
  for (const ParkingSlot& slot : map.markings.slots) parking.slots.push_back({slot.id, slot});
  return parking;
}

}  // namespace parkade
