#include "mapping/roadside/roadside.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"

namespace parkade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kAcross = 0.1;        // [m] between places across the path
constexpr double kOwnWidth = 0.8;      // [m] that the car itself has driven over
constexpr double kSolid = 0.3;         // [m] of anything else that ends free ground
constexpr double kLookedInto = 0.8;    // [m] behind the end that tell what it is
constexpr double kVehicleShare = 0.3;  // of what was seen there
constexpr double kHalfChord = 2.0;     // [m] along the path that tell its direction
constexpr double kMaxStep = 0.4;       // [m] up or down from the ground before
constexpr double kMaxLift = 1.2;       // [m] of a body's origin above the ground
constexpr double kBeyond = 8;          // [m] before and after a path
constexpr std::size_t kEndStates = 5;  // that tell its direction at its ends
constexpr float kFreeBelief = 0.5F;

/// The places where a body was, and straight on before the first and beyond the last: ground is
/// seen there, too.
std::vector<Vector3d> CornersOf(const Trajectory& site_from_body) {
  std::vector<Vector3d> corners;
  for (const TrajectoryState& state : site_from_body.states())
    if (const Vector3d& place = state.world_from_body.translation;
        corners.empty() || (place - corners.back()).norm() > Roadside::kStep)
      corners.push_back(place);
  if (corners.size() < 2) return {};
  const auto beyond = [](const Vector3d& last, const Vector3d& before) -> Vector3d {
    return last + kBeyond * (last - before).normalized();
  };
  const std::size_t back = std::min(corners.size() - 1, kEndStates);
  const Vector3d first = beyond(corners[0], corners[back]),
                 last = beyond(corners.back(), corners[corners.size() - 1 - back]);
  corners.insert(corners.begin(), first);
  corners.push_back(last);
  return corners;
}

/// Places along a path in equal steps, on the ground where that is known.
std::vector<Vector3d> PlacesOf(const CellFinder& cells, const Trajectory& site_from_body) {
  const std::vector<Vector3d> corners = CornersOf(site_from_body);
  std::vector<Vector3d> places;
  double at = 0;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const double length = (corners[i] - corners[i - 1]).norm();
    while (at < length) {
      Vector3d place = corners[i - 1] + at / length * (corners[i] - corners[i - 1]);
      const SurfaceCell* cell = cells.Find(place);
      if (cell != nullptr && std::abs(static_cast<double>(cell->height) - place.z()) < kMaxLift)
        place.z() = static_cast<double>(cell->height);
      places.push_back(place);
      at += Roadside::kStep;
    }
    at -= length;
  }
  return places;
}

enum class Cell { kUnseen, kFree, kVehicle, kOther };

/// \param height  [m] of the ground before; becomes that of this place, where it is known
Cell CellAt(const CellFinder& cells, const Vector2d& place, double& height) {
  const SurfaceCell* cell = cells.Find({place.x(), place.y(), height});
  if (cell == nullptr || std::abs(static_cast<double>(cell->height) - height) > kMaxStep)
    return Cell::kUnseen;
  height = static_cast<double>(cell->height);
  if (cell->free_belief > kFreeBelief) return Cell::kFree;
  return cell->Surface() == SurfaceClass::kVehicle ? Cell::kVehicle : Cell::kOther;
}

/// Looks outward from the path until free ground ends.
void LookOutward(const CellFinder& cells, RoadsideSection& section) {
  constexpr int kCount = static_cast<int>(Roadside::kReach / kAcross);
  std::array<Cell, kCount> row;
  double height = section.place.z();
  for (int i = 0; i < kCount; ++i)
    row[static_cast<std::size_t>(i)] = CellAt(cells, section.At(kOwnWidth + i * kAcross), height);
  const int solid = static_cast<int>(std::lround(kSolid / kAcross));
  int end = 0, others = 0;
  for (; end < kCount && others < solid; ++end)
    others = row[static_cast<std::size_t>(end)] == Cell::kFree ? 0 : others + 1;
  if (others < solid) return;
  end -= others;
  section.free_width = kOwnWidth + end * kAcross;
  int seen = 0, vehicles = 0;
  const int beyond = std::min(kCount, end + static_cast<int>(std::lround(kLookedInto / kAcross)));
  for (int i = end; i < beyond; ++i) {
    const Cell cell = row[static_cast<std::size_t>(i)];
    seen += cell == Cell::kVehicle || cell == Cell::kOther;
    vehicles += cell == Cell::kVehicle;
  }
  if (seen == 0 || row[static_cast<std::size_t>(end)] == Cell::kUnseen) return;
  section.end = vehicles > kVehicleShare * seen ? RoadsideEnd::kVehicle : RoadsideEnd::kOther;
}

Roadside LookAt(const CellFinder& cells, const std::vector<Vector3d>& places, double side) {
  Roadside roadside;
  const int count = static_cast<int>(places.size());
  const int half = static_cast<int>(kHalfChord / Roadside::kStep);
  for (int i = 0; i < count; ++i) {
    const Vector3d &before = places[static_cast<std::size_t>(std::max(0, i - half))],
                   &after = places[static_cast<std::size_t>(std::min(count - 1, i + half))];
    const Vector2d along = (after - before).head<2>().normalized();
    RoadsideSection section{places[static_cast<std::size_t>(i)],
                            side * Vector2d(along.y(), -along.x())};
    LookOutward(cells, section);
    roadside.sections.push_back(section);
  }
  if (side < 0) std::reverse(roadside.sections.begin(), roadside.sections.end());
  return roadside;
}

}  // namespace

std::vector<Roadside> LookBeside(const CellFinder& cells, std::span<const DrivenPath> paths) {
  return ParallelMap(2 * paths.size(), [&](std::size_t i) {
    return LookAt(cells, PlacesOf(cells, paths[i / 2].site_from_body), i % 2 == 0 ? 1.0 : -1.0);
  });
}

}  // namespace parkade
