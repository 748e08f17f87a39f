#include "export/lanelet2/lanelet2_map.h"

#include <array>
#include <cstdio>
#include <set>

#include "core/error.h"
#include "export/lanelet2/osm_file.h"
#include "export/lanelet2/parking_lots.h"

namespace parkade {
namespace {

constexpr double kMaxLowKerb = 0.06;  // [m]

std::string FormatMeters(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

void RequireLevel(std::optional<int> level, const ParkingLots& lots) {
  Require(!lots.lots.empty(), ErrorCode::kInvalidInput,
          "the map has neither free ground nor parking slots");
  std::set<int> levels;
  for (const LevelRing& lot : lots.lots) levels.insert(lot.level);
  std::string known;
  for (const int one : levels) known += (known.empty() ? "" : ", ") + std::to_string(one);
  Require(!level || levels.contains(*level), ErrorCode::kUsage,
          "the map has no level " + std::to_string(level.value_or(0)) + ", but: " + known);
}

/// A slot as Autoware has it: a rectangle about the line that a car's axis takes, in its direction.
struct Space {
  std::array<Eigen::Vector3d, 2> axis;  ///< [m] in site
  double width = 0;                     ///< [m]
};

/// Slots share their sides and are not quite rectangles: each becomes one of its mean size.
Space SpaceOf(const ParkingSlot& slot) {
  const auto& [a, b, c, d] = slot.corners;
  const std::array<Eigen::Vector3d, 2> inwards = {0.5 * (a + b), 0.5 * (d + c)};
  const std::array<Eigen::Vector3d, 2> along_lane = {0.5 * (b + c), 0.5 * (a + d)};
  const double depth = (inwards[1] - inwards[0]).norm();
  const double front = (along_lane[1] - along_lane[0]).norm();
  return depth >= front ? Space{inwards, front} : Space{along_lane, depth};
}

}  // namespace

std::string EncodeLanelet2(const ParkingMap& map, const std::optional<SiteDatum>& datum,
                           std::optional<int> level) {
  std::vector<ParkingSlot> slots;
  slots.reserve(map.slots.size());
  for (const NamedSlot& named : map.slots) slots.push_back(named.slot);
  const ParkingLots found = FindParkingLots(map.sheets, slots, map.cell_size);
  RequireLevel(level, found);
  const auto is_wanted = [&](int its_level) { return !level || its_level == *level; };

  OsmFile file(datum);
  for (const LevelRing& lot : found.lots)
    if (is_wanted(lot.level))
      file.AddPolygon(lot.ring, {{"type", "parking_lot"}, {"level", std::to_string(lot.level)}});
  for (const LevelRing& obstacle : found.obstacles)
    if (is_wanted(obstacle.level))
      file.AddPolygon(obstacle.ring,
                      {{"type", "obstacle"}, {"level", std::to_string(obstacle.level)}});
  for (const NamedSlot& named : map.slots) {
    const int its_level = LevelAt(named.slot.Center().z(), map.sheets);
    const Space space = SpaceOf(named.slot);
    if (is_wanted(its_level))
      file.AddLine(space.axis, {{"type", "parking_space"},
                                {"subtype", ToText(named.slot.kind)},
                                {"width", FormatMeters(space.width)},
                                {"name", named.name},
                                {"level", std::to_string(its_level)}});
  }
  for (const Kerb& kerb : map.kerbs) {
    const int its_level = LevelAt(kerb.points.front().z(), map.sheets);
    if (is_wanted(its_level))
      file.AddLine(kerb.points, {{"type", "curbstone"},
                                 {"subtype", kerb.height > kMaxLowKerb ? "high" : "low"},
                                 {"height", FormatMeters(kerb.height)},
                                 {"level", std::to_string(its_level)}});
  }
  return file.Encode();
}

}  // namespace parkade
