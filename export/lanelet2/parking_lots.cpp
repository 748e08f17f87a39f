#include "export/lanelet2/parking_lots.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "export/lanelet2/cell_region.h"
#include "export/lanelet2/corner_heights.h"
#include "export/lanelet2/simplify_ring.h"

namespace parkade {
namespace {

constexpr double kMinArea = 1.0;  // [m^2] of a lot without a slot

/// What shares one level, before and while lots are made of it.
struct Level {
  std::vector<const FreeSheet*> sheets;
  std::vector<const ParkingSlot*> slots;
};

std::map<int, Level> SortByLevel(std::span<const FreeSheet> sheets,
                                 std::span<const ParkingSlot> slots) {
  std::map<int, Level> levels;
  for (const FreeSheet& sheet : sheets) levels[sheet.level].sheets.push_back(&sheet);
  for (const ParkingSlot& slot : slots)
    levels[LevelAt(slot.Center().z(), sheets)].slots.push_back(&slot);
  return levels;
}

CellRegion RegionOf(const ParkingSlot& slot, double cell_size) {
  std::array<Eigen::Vector2d, 4> corners;
  for (size_t i = 0; i < 4; ++i) corners[i] = slot.corners[i].head<2>();
  return FillTouched(corners, cell_size);
}

/// The rows of `region` that `other` has, too.
CellRegion RowsOf(const CellRegion& region, const CellRegion& other) {
  const auto is_below = [](const CellSpan& span, int y) { return span.y < y; };
  const auto begin = std::lower_bound(region.begin(), region.end(), other.front().y, is_below);
  return {begin, std::lower_bound(begin, region.end(), other.back().y + 1, is_below)};
}

/// The slots' cells by the sheet that they belong to, and last those of slots that lie on none. No
/// cell is in two of them.
std::vector<CellRegion> GiveSlotsToSheets(const std::vector<CellRegion>& slots,
                                          const std::vector<CellRegion>& sheets) {
  std::vector<CellRegion> given(sheets.size() + 1);
  for (const CellRegion& slot : slots) {
    size_t owner = sheets.size();
    long most = 0;
    for (size_t i = 0; i < sheets.size(); ++i) {
      const long shared = CountCells(Intersect(RowsOf(sheets[i], slot), slot));
      if (shared > most) most = shared, owner = i;
    }
    given[owner].insert(given[owner].end(), slot.begin(), slot.end());
  }
  CellRegion taken;
  for (CellRegion& cells : given) {
    cells = Subtract(cells, taken);
    taken = Unite(taken, cells);
  }
  return given;
}

/// The lots of one level as sets of cells, each connected.
std::vector<CellRegion> FindLots(const Level& level, double cell_size) {
  std::vector<CellRegion> sheets, slots;
  for (const FreeSheet* sheet : level.sheets) sheets.push_back(FillRings(sheet->rings, cell_size));
  for (const ParkingSlot* slot : level.slots) slots.push_back(RegionOf(*slot, cell_size));
  const std::vector<CellRegion> given = GiveSlotsToSheets(slots, sheets);
  CellRegion of_slots;
  for (const CellRegion& cells : given) of_slots = Unite(of_slots, cells);

  std::vector<CellRegion> lots;
  for (size_t i = 0; i < given.size(); ++i) {
    const CellRegion free = i < sheets.size() ? Subtract(sheets[i], of_slots) : CellRegion();
    for (CellRegion& piece : SplitIntoPieces(Unite(free, given[i]))) {
      const double area = static_cast<double>(CountCells(piece)) * cell_size * cell_size;
      if (area >= kMinArea || !Intersect(piece, given[i]).empty()) lots.push_back(std::move(piece));
    }
  }
  return lots;
}

/// Adds the outlines of a region, cut by lines along y until no part has a hole.
void AppendWithoutHoles(const CellRegion& region, double cell_size, std::vector<Ring>& outlines) {
  std::vector<Ring> rings = TraceBoundary(region, cell_size);
  if (rings.size() == 1) return outlines.push_back(std::move(rings.front()));
  const auto [west, east] = std::minmax_element(
      rings[1].begin(), rings[1].end(),
      [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.x() < b.x(); });
  const int cut = static_cast<int>(std::lround(0.5 * (west->x() + east->x()) / cell_size));
  CellRegion left, right;
  for (const CellSpan& span : region) {
    if (span.begin < cut) left.push_back({span.y, span.begin, std::min(span.end, cut)});
    if (span.end > cut) right.push_back({span.y, std::max(span.begin, cut), span.end});
  }
  for (const CellRegion* half : {&left, &right})
    for (const CellRegion& piece : SplitIntoPieces(*half))
      AppendWithoutHoles(piece, cell_size, outlines);
}

/// Adds one level, with heights and all corners.
void AppendLevel(int index, const Level& level, double cell_size, ParkingLots& found) {
  const CornerHeights heights(level.sheets, level.slots, cell_size);
  const std::vector<CellRegion> lots = FindLots(level, cell_size);
  std::vector<CellRegion> filled;
  CellRegion all_lots, all_filled;
  for (const CellRegion& lot : lots) {
    const Ring outline = TraceBoundary(lot, cell_size).front();
    filled.push_back(FillRings({&outline, 1}, cell_size));
    all_lots = Unite(all_lots, lot);
    all_filled = Unite(all_filled, filled.back());
  }
  for (size_t i = 0; i < lots.size(); ++i) {
    bool is_enclosed = false;
    for (size_t k = 0; k < lots.size(); ++k)
      is_enclosed |= k != i && !Intersect(RowsOf(filled[k], lots[i]), lots[i]).empty();
    if (is_enclosed) continue;
    found.lots.push_back({index, heights.Lift(TraceBoundary(lots[i], cell_size).front())});
  }
  std::vector<Ring> outlines;
  for (const CellRegion& piece : SplitIntoPieces(Subtract(all_filled, all_lots)))
    AppendWithoutHoles(piece, cell_size, outlines);
  for (Ring& outline : outlines)
    found.obstacles.push_back({index, heights.Lift(std::move(outline))});
}

/// For each corner of each lot, whether another lot has it, too, at about the same height.
std::vector<std::vector<bool>> FindSharedCorners(const std::vector<LevelRing>& lots,
                                                 double cell_size) {
  constexpr double kMaxStep = 0.5;  // [m] less than between decks
  const auto key_of = [&](const Eigen::Vector3d& corner) {
    return CellKey(static_cast<int>(std::lround(corner.x() / cell_size)),
                   static_cast<int>(std::lround(corner.y() / cell_size)));
  };
  std::map<std::int64_t, std::vector<std::pair<size_t, double>>> lots_at;
  for (size_t i = 0; i < lots.size(); ++i)
    for (const Eigen::Vector3d& corner : lots[i].ring)
      lots_at[key_of(corner)].emplace_back(i, corner.z());
  std::vector<std::vector<bool>> is_shared;
  for (size_t i = 0; i < lots.size(); ++i) {
    std::vector<bool>& of_lot = is_shared.emplace_back();
    for (const Eigen::Vector3d& corner : lots[i].ring) {
      const auto& there = lots_at.at(key_of(corner));
      of_lot.push_back(std::any_of(there.begin(), there.end(), [&](const auto& other) {
        return other.first != i && std::abs(other.second - corner.z()) < kMaxStep;
      }));
    }
  }
  return is_shared;
}

}  // namespace

ParkingLots FindParkingLots(std::span<const FreeSheet> sheets, std::span<const ParkingSlot> slots,
                            double cell_size) {
  ParkingLots found;
  for (const auto& [index, level] : SortByLevel(sheets, slots))
    AppendLevel(index, level, cell_size, found);
  std::vector<std::vector<bool>> is_shared = FindSharedCorners(found.lots, cell_size);
  for (size_t i = 0; i < found.lots.size(); ++i)
    found.lots[i].ring = LeaveOutLeftBends(found.lots[i].ring, cell_size, std::move(is_shared[i]));
  for (LevelRing& obstacle : found.obstacles)
    obstacle.ring = LeaveOutRightBends(obstacle.ring, cell_size,
                                       std::vector<bool>(obstacle.ring.size(), false));
  return found;
}

}  // namespace parkade
