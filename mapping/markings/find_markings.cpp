#include "mapping/markings/find_markings.h"

#include <algorithm>
#include <cmath>

#include "core/log.h"
#include "mapping/ground/cell_finder.h"

namespace parkade {
namespace {

constexpr double kMinLineContrast =
    0.12;  // of lines that are written down; fainter ones only bound slots
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBesideSlot = 0.2;  // [m] of a line to the side of the slot that it bounds
constexpr double kParallel = 0.98;   // cosine of the angle between two lines
constexpr double kInArea = 0.15;     // [m] from an area's outline at which a line is a part of it
constexpr double kMaxHeightStep = 1.2;  // [m] between things of one deck

Vector3d OnSurface(const CellFinder& cells, const Vector2d& place, double height) {
  Vector3d point(place.x(), place.y(), height);
  if (const SurfaceCell* cell = cells.Find(point); cell != nullptr)
    if (std::abs(static_cast<double>(cell->height) - height) < kMaxHeightStep)
      point.z() = static_cast<double>(cell->height);
  return point;
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
  lines.Validate();
  slots.Validate();
  kerbs.Validate();
}

GroundMarkings FindMarkings(const MarkedGround& ground, const MarkingOptions& options) {
  options.Validate();
  GroundMarkings markings;
  if (!options.enabled) return markings;
  markings.bumps = FindSpeedBumps(ground.surface, ground.paths);
  markings.kerbs =
      FindKerbs(ground.mesh, ground.surface, ground.patches, ground.paths, options.kerbs);
  const CellFinder cells(ground.surface);
  const Paint paint = FindPaint(ground, options.lines);
  markings.slots = FindSlots(ground, paint, options.slots);
  markings.markings = MarkingsOf(paint, markings.slots, cells, kMinLineContrast);
  LogInfo("stage=find_markings lines=" + std::to_string(paint.lines.size()) +
          " slots=" + std::to_string(markings.slots.size()) +
          " markings=" + std::to_string(markings.markings.size()) +
          " bumps=" + std::to_string(markings.bumps.size()) +
          " kerbs=" + std::to_string(markings.kerbs.size()));
  return markings;
}

}  // namespace parkade
