#include "mapping/markings/find_markings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "mapping/ground/cell_finder.h"
#include "mapping/ground/quadrilateral.h"

namespace parkade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMargin = 7.0;        // [m] around tiles: lines reach into the next one
constexpr double kBesideSlot = 0.2;    // [m] of a line to the side of the slot that it bounds
constexpr double kParallel = 0.98;     // cosine of the angle between two lines
constexpr double kInArea = 0.15;       // [m] from an area's outline at which a line is a part of it
constexpr double kSureSlot = 0.9;      // confidence
constexpr double kInside = 0.4;        // [m] from a slot's sides
constexpr double kParkingSpeed = 2.0;  // [m/s]
constexpr double kMaxHeightStep = 1.2;  // [m] between things of one deck
constexpr float kBareBelief = 0.8F;     // of free ground where a line would have been seen

Vector3d OnSurface(const CellFinder& cells, const Vector2d& place, double height) {
  Vector3d point(place.x(), place.y(), height);
  if (const SurfaceCell* cell = cells.Find(point); cell != nullptr)
    if (std::abs(static_cast<double>(cell->height) - height) < kMaxHeightStep)
      point.z() = static_cast<double>(cell->height);
  return point;
}

/// Corners that lie on no ground get the mean height of the others, or of the ground at the slot's
/// sides.
std::array<Vector3d, 4> LiftCorners(const PlanarSlot& slot, const CellFinder& cells) {
  std::array<Vector3d, 4> corners;
  std::array<bool, 4> is_known{};
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d& place = slot.corners[i];
    const SurfaceCell* cell = cells.Find({place.x(), place.y(), slot.height});
    is_known[i] = cell != nullptr &&
                  std::abs(static_cast<double>(cell->height) - slot.height) < kMaxHeightStep;
    corners[i] = {place.x(), place.y(),
                  is_known[i] ? static_cast<double>(cell->height) : slot.height};
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
  slot.corners = LiftCorners(planar, cells);
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

double DistanceToSegment(const Vector2d& point, const Vector2d& begin, const Vector2d& end) {
  const Vector2d side = end - begin;
  const double share =
      std::clamp((point - begin).dot(side) / std::max(1e-12, side.squaredNorm()), 0.0, 1.0);
  return (point - begin - share * side).norm();
}

bool IsOfSlot(const PaintLine& line, const std::vector<ParkingSlot>& slots) {
  return std::any_of(slots.begin(), slots.end(), [&](const ParkingSlot& slot) {
    if (std::abs(slot.corners[0].z() - line.height) > kMaxHeightStep) return false;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector2d begin = slot.corners[i].head<2>(), end = slot.corners[(i + 1) % 4].head<2>();
      if (std::abs(line.Direction().dot((end - begin).normalized())) > kParallel &&
          DistanceToSegment(line.Middle(), begin, end) < kBesideSlot)
        return true;
    }
    return false;
  });
}

bool IsInArea(const PaintLine& line, const std::vector<PaintArea>& areas) {
  return std::any_of(areas.begin(), areas.end(), [&](const PaintArea& area) {
    if (std::abs(area.height - line.height) > kMaxHeightStep) return false;
    bool is_inside = false;
    for (std::size_t i = 0, last = area.outline.size() - 1; i < area.outline.size(); last = i++) {
      const Vector2d &a = area.outline[i], &b = area.outline[last], place = line.Middle();
      if (DistanceToSegment(place, a, b) < kInArea) return true;
      if ((a.y() > place.y()) != (b.y() > place.y()) &&
          place.x() < a.x() + (place.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
        is_inside = !is_inside;
    }
    return is_inside;
  });
}

struct Paint {
  std::vector<PaintLine> lines;
  std::vector<PaintArea> areas;
};

Paint FindPaint(const MarkedGround& ground, const MarkingOptions& options) {
  const GroundTiles tiles(ground.mesh, ground.surface, ground.texture, kMargin);
  const auto found = ParallelMap(tiles.size(), [&](std::size_t i) {
    const GroundTile tile = tiles.Make(i);
    return Paint{FindPaintLines(tile, options.lines), FindPaintAreas(tile, options.areas)};
  });
  Paint all;
  for (const Paint& paint : found) {
    all.lines.insert(all.lines.end(), paint.lines.begin(), paint.lines.end());
    all.areas.insert(all.areas.end(), paint.areas.begin(), paint.areas.end());
  }
  return all;
}

std::vector<RoadMarking> MarkingsOf(const Paint& paint, const std::vector<ParkingSlot>& slots,
                                    const CellFinder& cells, double min_contrast) {
  std::vector<RoadMarking> markings;
  for (const PaintLine& line : paint.lines) {
    const bool is_of_slot = IsOfSlot(line, slots);
    if (!is_of_slot &&
        (line.is_one_sided || line.contrast < min_contrast || IsInArea(line, paint.areas)))
      continue;
    markings.push_back(
        {RoadMarking::Shape::kLine,
         line.is_yellow,
         is_of_slot,
         line.width,
         {OnSurface(cells, line.begin, line.height), OnSurface(cells, line.end, line.height)}});
  }
  for (const PaintArea& area : paint.areas) {
    RoadMarking marking{RoadMarking::Shape::kArea, area.is_yellow, false, 0, {}};
    for (const Vector2d& point : area.outline)
      marking.points.push_back(OnSurface(cells, point, area.height));
    markings.push_back(std::move(marking));
  }
  return markings;
}

}  // namespace

void MarkingOptions::Validate() const {
  Require(min_line_contrast > 0, ErrorCode::kUsage, "min_line_contrast must be > 0");
  lines.Validate();
  areas.Validate();
  slots.Validate();
  states.Validate();
  bumps.Validate();
  kerbs.Validate();
}

GroundMarkings FindMarkings(const MarkedGround& ground, const MarkingOptions& options) {
  options.Validate();
  GroundMarkings markings;
  if (!options.enabled) return markings;
  markings.bumps = FindSpeedBumps(ground.surface, ground.paths, options.bumps);
  markings.kerbs =
      FindKerbs(ground.mesh, ground.surface, ground.patches, ground.paths, options.kerbs);
  const CellFinder cells(ground.surface);
  Paint paint = FindPaint(ground, options);
  for (PaintLine& line : paint.lines)
    line.height = OnSurface(cells, line.Middle(), line.height).z();
  for (PaintArea& area : paint.areas)
    area.height = OnSurface(cells, area.outline.front(), area.height).z();
  const auto is_bare = [&](const Vector2d& place, double height) {
    const SurfaceCell* cell = cells.Find({place.x(), place.y(), height});
    return cell != nullptr && cell->free_belief > kBareBelief &&
           std::abs(static_cast<double>(cell->height) - height) < kMaxHeightStep;
  };
  for (const PlanarSlot& slot : FindSlotRows(paint.lines, options.slots, is_bare))
    if (!IsDrivenThrough(slot, ground.paths))
      markings.slots.push_back(PlaceSlot(slot, cells, ground.paths));
  SeeSlots(ground.patches, ground.paths, ground.num_drives, options.states, markings.slots);
  markings.markings = MarkingsOf(paint, markings.slots, cells, options.min_line_contrast);
  LogInfo("stage=find_markings lines=" + std::to_string(paint.lines.size()) +
          " slots=" + std::to_string(markings.slots.size()) +
          " markings=" + std::to_string(markings.markings.size()) +
          " bumps=" + std::to_string(markings.bumps.size()) +
          " kerbs=" + std::to_string(markings.kerbs.size()));
  return markings;
}

}  // namespace parkade
