#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace parkade {

/// How a parking slot lies to the row that it is in.
enum class SlotKind { kPerpendicular, kAngled, kParallel };

/// What one drive saw in a slot.
enum class SlotState {
  kUnseen,    ///< too little of it to tell
  kFree,      ///< its ground
  kOccupied,  ///< something that stands on it
};

/// "perpendicular", "angled", "parallel".
inline const char* ToText(SlotKind kind) {
  switch (kind) {
    case SlotKind::kPerpendicular: return "perpendicular";
    case SlotKind::kAngled: return "angled";
    case SlotKind::kParallel: return "parallel";
  }
  return "";
}

/// "unseen", "free", "occupied".
inline const char* ToText(SlotState state) {
  switch (state) {
    case SlotState::kUnseen: return "unseen";
    case SlotState::kFree: return "free";
    case SlotState::kOccupied: return "occupied";
  }
  return "";
}

/// A parking space: between the middles of the painted lines beside it, or as cars stand at a kerb.
struct ParkingSlot {
  std::string id = {};  ///< the same in all versions of a map; empty until it is named
  std::array<Eigen::Vector3d, 4>
      corners{};  ///< [m] in site, counter-clockwise; the first two are its entrance
  SlotKind kind = SlotKind::kPerpendicular;
  double angle = 0;       ///< [rad] in (0, pi/2] between a line beside it and the row; parallel: 0
  double confidence = 0;  ///< 0 to 1
  int num_marked_sides = 0;  ///< sides whose line was seen; the others follow from the row
  std::vector<SlotState> states = {};  ///< by drive

  Eigen::Vector3d Center() const {
    return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  }
  double Entrance() const { return (corners[1] - corners[0]).norm(); }  ///< [m]
  double Depth() const {
    return (corners[3] - corners[0]).norm();
  }  ///< [m] from the entrance inwards
  double Width() const {
    return std::min(Entrance(), Depth());
  }  ///< [m] the side that a car's width takes
  double Length() const {
    return std::max(Entrance(), Depth());
  }  ///< [m] the side that a car's length takes
};

/// Paint on the ground that is not said by slots alone.
struct RoadMarking {
  enum class Shape { kLine, kArea };
  Shape shape = Shape::kLine;
  bool is_yellow = false;   ///< else white
  bool is_of_slot = false;  ///< a line beside a slot
  double width = 0;         ///< [m] of a line
  std::vector<Eigen::Vector3d>
      points{};  ///< [m] in site: the ends of a line; the ring of an area, not closed
};

/// A ridge across the way that a car drove over.
struct SpeedBump {
  Eigen::Vector3d crest = Eigen::Vector3d::Zero();  ///< [m] in site, on the driven path
  double yaw = 0;                                   ///< [rad] of the way over it
  double height = 0;                                ///< [m] above the ground before and behind
  double length = 0;   ///< [m] along the way, where it is higher than a tenth of that
  int num_passes = 0;  ///< axles of which drives felt it
};

/// A step at the border of the drivable ground up to something level: a pavement, an island, a
/// verge.
struct Kerb {
  std::vector<Eigen::Vector3d> points =
      {};                    ///< [m] in site, along its foot; the drivable ground lies on the left
  double height = 0;         ///< [m] of its top above that ground
  double height_sigma = 0;   ///< [m]
  double hidden_length = 0;  ///< [m] of it that nobody saw: behind parked cars

  double Length() const {  ///< [m]
    double length = 0;
    for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
    return length;
  }
};

/// What is painted on the ground and what stands out of it.
struct GroundMarkings {
  std::vector<ParkingSlot> slots = {};  ///< by the look that found them, by row, then along it
  std::vector<RoadMarking> markings = {};
  std::vector<SpeedBump> bumps = {};
  std::vector<Kerb> kerbs = {};
};

}  // namespace parkade
