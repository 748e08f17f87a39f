#include "mapping/markings/find_slots.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "mapping/ground/cell_finder.h"
#include "mapping/ground/quadrilateral.h"
#include "mapping/markings/ground_tiles.h"
#include "mapping/markings/slot_rows.h"
#include "mapping/markings/slot_sides.h"
#include "mapping/markings/slot_states.h"
#include "mapping/roadside/roadside_slots.h"

namespace parkade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMargin = 7.0;         // [m] around tiles: lines reach into the next one
constexpr double kSureSlot = 0.9;       // confidence
constexpr double kInside = 0.4;         // [m] from a slot's sides
constexpr double kParkingSpeed = 2.0;   // [m/s]
constexpr double kMaxHeightStep = 1.2;  // [m] between things of one deck
constexpr double kMarkedNear = 12;      // [m] around marked slots, where cars stand in such
constexpr double kMaxShare = 0.2;       // of a slot that a marked one may cover
constexpr float kBareBelief = 0.8F;     // of free ground where a line would have been seen

double HeightAt(const CellFinder& cells, const Vector2d& place, double height) {
  const SurfaceCell* cell = cells.Find({place.x(), place.y(), height});
  const bool is_of_deck =
      cell != nullptr && std::abs(static_cast<double>(cell->height) - height) < kMaxHeightStep;
  return is_of_deck ? static_cast<double>(cell->height) : height;
}

/// Corners that lie on no ground get the mean height of the others, or of the ground at the slot's
/// sides.
std::array<Vector3d, 4> LiftCorners(const std::array<Vector2d, 4>& places, double height,
                                    const CellFinder& cells) {
  std::array<Vector3d, 4> corners;
  std::array<bool, 4> is_known{};
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d& place = places[i];
    const SurfaceCell* cell = cells.Find({place.x(), place.y(), height});
    is_known[i] =
        cell != nullptr && std::abs(static_cast<double>(cell->height) - height) < kMaxHeightStep;
    corners[i] = {place.x(), place.y(), is_known[i] ? static_cast<double>(cell->height) : height};
    if (is_known[i]) sum += corners[i].z(), ++count;
  }
  for (std::size_t i = 0; i < 4; ++i)
    if (!is_known[i] && count > 0) corners[i].z() = sum / count;
  return corners;
}

/// [m] squared from a place to the nearest place that a car drove over on the same deck.
double DistanceToPaths(const Vector3d& place, std::span<const DrivenPath> paths) {
  double nearest = std::numeric_limits<double>::max();
  for (const DrivenPath& path : paths)
    for (const TrajectoryState& state : path.site_from_body.states()) {
      const Vector3d offset = state.world_from_body.translation - place;
      if (std::abs(offset.z()) < 2) nearest = std::min(nearest, offset.head<2>().squaredNorm());
    }
  return nearest;
}

/// A slot on the ground: of its ends (along parallel slots: of its sides) the one nearer to where
/// cars drove comes first.
ParkingSlot PlaceSlot(const PlanarSlot& planar, const CellFinder& cells,
                      std::span<const DrivenPath> paths) {
  ParkingSlot slot;
  slot.corners = LiftCorners(planar.corners, planar.height, cells);
  slot.kind = planar.kind;
  slot.angle = planar.angle;
  slot.confidence = planar.confidence;
  slot.num_marked_sides = planar.num_marked_sides;
  const auto side_length = [&](std::size_t i) {
    return (slot.corners[(i + 1) % 4] - slot.corners[i]).norm();
  };
  const bool enters_long_side = planar.kind == SlotKind::kParallel;
  if ((side_length(0) > side_length(1)) != enters_long_side)
    std::rotate(slot.corners.begin(), slot.corners.begin() + 1, slot.corners.end());
  const auto middle = [&](std::size_t i) -> Vector3d {
    return 0.5 * (slot.corners[i] + slot.corners[(i + 1) % 4]);
  };
  if (DistanceToPaths(middle(2), paths) < DistanceToPaths(middle(0), paths))
    std::rotate(slot.corners.begin(), slot.corners.begin() + 2, slot.corners.end());
  return slot;
}

/// Whether a car drove through a slot that is not sure, faster than one parks: then it is a lane's
/// arrows or stripes.
bool IsDrivenThrough(const PlanarSlot& slot, std::span<const DrivenPath> paths) {
  if (slot.confidence > kSureSlot) return false;
  for (const DrivenPath& path : paths) {
    const std::vector<TrajectoryState>& states = path.site_from_body.states();
    for (std::size_t i = 1; i < states.size(); ++i) {
      const Vector3d& place = states[i].world_from_body.translation;
      if (std::abs(place.z() - slot.height) > 2 ||
          !Contains(slot.corners, place.head<2>(), kInside))
        continue;
      const double seconds = states[i].time - states[i - 1].time;
      if ((place - states[i - 1].world_from_body.translation).norm() > kParkingSpeed * seconds)
        return true;
    }
  }
  return false;
}

/// What parked cars alone say.
std::vector<PlanarSlot> LookAlongKerbs(const CellFinder& cells, std::span<const DrivenPath> paths) {
  std::vector<PlanarSlot> slots;
  for (const RoadsideSlot& found : FindRoadsideSlots(cells, paths))
    slots.push_back({.corners = found.corners,
                     .height = found.height,
                     .kind = SlotKind::kParallel,
                     .confidence = found.confidence});
  return slots;
}

Quadrilateral OutlineOf(const ParkingSlot& slot) {
  Quadrilateral outline;
  for (std::size_t i = 0; i < 4; ++i) outline[i] = slot.corners[i].head<2>();
  return outline;
}

/// Whether cars alone make no slot as another one is marked: near rows of an aisle they stand in
/// these, along a kerb beside them.
bool GivesWayTo(const ParkingSlot& slot, const ParkingSlot& marked) {
  const Vector3d offset = marked.Center() - slot.Center();
  if (std::abs(offset.z()) > kMaxHeightStep || offset.head<2>().norm() > kMarkedNear) return false;
  const Quadrilateral outline = OutlineOf(slot);
  return marked.kind != SlotKind::kParallel ||
         SharedArea(outline, OutlineOf(marked)) > kMaxShare * SignedArea(outline);
}

/// Takes out unmarked slots that give way to any of `others`.
void DropNearMarked(std::span<const ParkingSlot> others, std::vector<ParkingSlot>& slots) {
  std::erase_if(slots, [&](const ParkingSlot& slot) {
    return !IsMarked(slot) &&
           std::any_of(others.begin(), others.end(), [&](const ParkingSlot& other) {
             return IsMarked(other) && GivesWayTo(slot, other);
           });
  });
}

/// The slots that the texture shows by itself, and those that parked cars do.
std::vector<ParkingSlot> LookForSlots(const MarkedGround& ground, const Paint& paint,
                                      const CellFinder& cells, const SlotRowOptions& options) {
  const auto is_bare = [&](const Vector2d& place, double height) {
    const SurfaceCell* cell = cells.Find({place.x(), place.y(), height});
    return cell != nullptr && cell->free_belief > kBareBelief &&
           std::abs(static_cast<double>(cell->height) - height) < kMaxHeightStep;
  };
  std::vector<ParkingSlot> slots;
  for (const PlanarSlot& slot : FindSlotRows(paint.lines, options, is_bare))
    if (!IsDrivenThrough(slot, ground.paths)) slots.push_back(PlaceSlot(slot, cells, ground.paths));
  for (const PlanarSlot& slot : LookAlongKerbs(cells, ground.paths))
    if (slot.confidence >= options.min_confidence && !IsDrivenThrough(slot, ground.paths))
      slots.push_back(PlaceSlot(slot, cells, ground.paths));
  DropNearMarked(std::vector(slots), slots);
  return slots;
}

/// Slots that were found elsewhere, on the ground of this site.
void Lift(std::vector<ParkingSlot>& slots, const CellFinder& cells) {
  for (ParkingSlot& slot : slots)
    slot.corners = LiftCorners(OutlineOf(slot), slot.Center().z(), cells);
}

}  // namespace

Paint FindPaint(const MarkedGround& ground, const PaintLineOptions& options) {
  const GroundTiles tiles(ground.mesh, ground.surface, ground.texture, kMargin);
  const auto found = ParallelMap(tiles.size(), [&](std::size_t i) {
    const GroundTile tile = tiles.Make(i);
    return Paint{FindPaintLines(tile, options), FindPaintAreas(tile)};
  });
  const CellFinder cells(ground.surface);
  Paint all;
  for (const Paint& paint : found) {
    all.lines.insert(all.lines.end(), paint.lines.begin(), paint.lines.end());
    all.areas.insert(all.areas.end(), paint.areas.begin(), paint.areas.end());
  }
  for (PaintLine& line : all.lines) line.height = HeightAt(cells, line.Middle(), line.height);
  for (PaintArea& area : all.areas)
    area.height = HeightAt(cells, area.outline.front(), area.height);
  return all;
}

std::vector<ParkingSlot> FindSlots(const MarkedGround& ground, const Paint& paint,
                                   const SlotRowOptions& options) {
  const CellFinder cells(ground.surface);
  SlotLook now{LookForSlots(ground, paint, cells, options),
               static_cast<int>(ground.num_drives) - 1};
  if (ground.known.empty()) {
    SeeSlots(ground.patches, ground.paths, ground.num_drives, now.slots);
    return now.slots;
  }
  std::vector<SlotLook> looks = ground.known;
  for (SlotLook& look : looks) {
    Lift(look.slots, cells);
    if (look.establishes) DropNearMarked(look.slots, now.slots);
  }
  looks.push_back(std::move(now));
  std::vector<SlotCandidate> candidates = MatchLooks(looks);
  std::vector<ParkingSlot> slots;
  slots.reserve(candidates.size());
  std::vector<KnownStates> known;
  for (const SlotCandidate& candidate : candidates) {
    slots.push_back(candidate.slot);
    known.push_back(candidate.known);
  }
  SeeSlots(ground.patches, ground.paths, ground.num_drives, slots, known);
  const std::vector<SlotSides> sides =
      SeeSides(GroundTiles(ground.mesh, ground.surface, ground.texture, kMargin), slots);
  for (std::size_t i = 0; i < slots.size(); ++i) {
    candidates[i].slot.states = std::move(slots[i].states);
    candidates[i].sides = sides[i];
  }
  return ChooseSlots(candidates);
}

}  // namespace parkade
