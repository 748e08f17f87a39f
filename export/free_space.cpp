#include "export/free_space.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>

#include "core/error.h"
#include "core/files/for_each_releasing.h"
#include "export/geojson.h"

namespace parkade {
namespace {

using Cells = FileBackedVector<SurfaceCell>;
using Indices = FileBackedVector<int>;  // of cells

constexpr int kNone = -1;
constexpr double kHeightBin = 0.05;  // [m]
constexpr double kSheetSlack = 0.5;  // [m] by which things may lie beside a sheet's heights

/// Free cells sorted by (y, x, height), of which no two of one (x, y) are closer than a deck's
/// height.
Cells SelectFreeCells(const SurfaceMap& surface, const FreeSpaceOptions& options) {
  Cells free_cells;
  free_cells.reserve(surface.cells.size());
  ForEachReleasing(
      surface.cells,
      [&](size_t i) {
        const SurfaceCell& cell = surface.cells[i];
        if (!(static_cast<double>(cell.free_belief) > options.min_belief)) return;
        const bool is_double =
            !free_cells.empty() && free_cells.back().x == cell.x && free_cells.back().y == cell.y &&
            static_cast<double>(cell.height - free_cells.back().height) < options.deck_height;
        if (!is_double) free_cells.push_back(cell);
      },
      free_cells);
  return free_cells;
}

/// Connects cells through their edges where the height hardly changes.
class CellGraph {
 public:
  CellGraph(Cells&& cells, double max_step)
      : cells_(std::move(cells)), max_step_(max_step), is_open_(cells_.size(), false) {
    if (!cells_.empty())
      row_begins_.resize(static_cast<size_t>(cells_.back().y - cells_.front().y) + 2,
                         cells_.size());
    for (size_t i = cells_.size(); i-- > 0;)
      row_begins_[static_cast<size_t>(cells_[i].y - cells_.front().y)] = i;
    for (size_t row = row_begins_.size(); row-- > 1;)
      row_begins_[row - 1] = std::min(row_begins_[row - 1], row_begins_[row]);
  }

  const Cells& cells() const { return cells_; }

  /// Indices of the connected parts of `members`; a cell joins only a part of its own `slice`.
  std::vector<Indices> FindParts(const Indices& members, const Indices& slice) {
    std::vector<Indices> parts;
    for (const int index : members) is_open_[static_cast<size_t>(index)] = true;
    for (const int seed : members) {
      if (!is_open_[static_cast<size_t>(seed)]) continue;
      is_open_[static_cast<size_t>(seed)] = false;
      Indices part = {seed};
      for (size_t i = 0; i < part.size(); ++i) {
        for (const int next : Neighbors(part[i])) {
          if (next == kNone || !is_open_[static_cast<size_t>(next)]) continue;
          if (slice[static_cast<size_t>(next)] != slice[static_cast<size_t>(seed)]) continue;
          is_open_[static_cast<size_t>(next)] = false;
          part.push_back(next);
        }
      }
      parts.push_back(std::move(part));
    }
    return parts;
  }

 private:
  std::array<int, 4> Neighbors(int index) const {
    const SurfaceCell& cell = cells_[static_cast<size_t>(index)];
    return {Find(cell.x + 1, cell.y, cell.height), Find(cell.x, cell.y + 1, cell.height),
            Find(cell.x - 1, cell.y, cell.height), Find(cell.x, cell.y - 1, cell.height)};
  }

  /// The cell at (x, y) within the step of a height: decks are further apart, so there is at most
  /// one.
  int Find(int x, int y, float height) const {
    const int row = y - cells_.front().y;
    if (row < 0 || static_cast<size_t>(row) + 1 >= row_begins_.size()) return kNone;
    const SurfaceCell* begin = cells_.data() + row_begins_[static_cast<size_t>(row)];
    const SurfaceCell* end = cells_.data() + row_begins_[static_cast<size_t>(row) + 1];
    const SurfaceCell* cell = std::lower_bound(
        begin, end, x, [](const SurfaceCell& other, int at) { return other.x < at; });
    for (; cell != end && cell->x == x; ++cell)
      if (std::abs(static_cast<double>(cell->height - height)) <= max_step_)
        return static_cast<int>(cell - cells_.data());
    return kNone;
  }

  Cells cells_;
  double max_step_;
  std::vector<size_t> row_begins_;  ///< from the lowest y on, and where the last row ends
  std::vector<bool> is_open_;       ///< members not yet in a part; all false between calls
};

/// The fewest heights [m] that lie between the cells of every (x, y) that has several. Each is
/// chosen where the part has the least ground, so that ramps are cut and not decks. Increasing.
/// Greedy stabbing of intervals.
std::vector<double> FindCuts(const Cells& cells, Indices part) {
  std::sort(part.begin(), part.end());
  std::vector<std::pair<double, double>> gaps;  // (upper, lower) height
  std::map<int, int> ground_at;                 // cells by height bin
  for (size_t i = 0; i < part.size(); ++i) {
    const SurfaceCell& cell = cells[static_cast<size_t>(part[i])];
    ++ground_at[static_cast<int>(std::floor(static_cast<double>(cell.height) / kHeightBin))];
    if (i == 0) continue;
    const SurfaceCell& below = cells[static_cast<size_t>(part[i - 1])];
    if (below.x == cell.x && below.y == cell.y)
      gaps.emplace_back(static_cast<double>(cell.height), static_cast<double>(below.height));
  }
  std::sort(gaps.begin(), gaps.end());

  std::vector<double> cuts;
  for (size_t i = 0; i < gaps.size();) {
    const double upper = gaps[i].first;
    double lower = gaps[i].second;
    for (; i < gaps.size() && gaps[i].second < upper; ++i) lower = std::max(lower, gaps[i].second);
    const double middle = 0.5 * (lower + upper);
    double best = middle;
    auto best_cost = std::pair(std::numeric_limits<int>::max(), 0.0);
    for (int bin = static_cast<int>(std::ceil(lower / kHeightBin)); (bin + 1) * kHeightBin <= upper;
         ++bin) {
      const double height = (bin + 0.5) * kHeightBin;
      const auto found = ground_at.find(bin);
      const std::pair cost(found == ground_at.end() ? 0 : found->second, std::abs(height - middle));
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = height;
    }
    cuts.push_back(best);
  }
  return cuts;
}

FreeSheet MakeSheet(const Cells& all_cells, Indices&& part, double cell_size) {
  FreeSheet sheet;
  sheet.area = static_cast<double>(part.size()) * cell_size * cell_size;
  sheet.min_height = sheet.max_height =
      static_cast<double>(all_cells[static_cast<size_t>(part[0])].height);
  double sum = 0;
  for (const int index : part) {
    const double height = static_cast<double>(all_cells[static_cast<size_t>(index)].height);
    sheet.min_height = std::min(sheet.min_height, height);
    sheet.max_height = std::max(sheet.max_height, height);
    sum += height;
  }
  sheet.mean_height = sum / static_cast<double>(part.size());
  std::sort(part.begin(), part.end());
  Cells cells;
  cells.reserve(part.size());
  for (const int index : part) cells.push_back(all_cells[static_cast<size_t>(index)]);
  sheet.rings = TraceBoundary(cells, cell_size);
  return sheet;
}

}  // namespace

void FreeSpaceOptions::Validate() const {
  Require(min_belief >= 0 && min_belief < 1, ErrorCode::kUsage, "'min_belief' must be in 0..1");
  Require(max_step > 0, ErrorCode::kUsage, "'max_step' must be positive");
  Require(min_area >= 0, ErrorCode::kUsage, "'min_area' must not be negative");
  Require(deck_height > 0, ErrorCode::kUsage, "'deck_height' must be positive");
}

std::vector<FreeSheet> FindFreeSheets(const SurfaceMap& surface, const FreeSpaceOptions& options) {
  options.Validate();
  CellGraph graph(SelectFreeCells(surface, options), options.max_step);
  Indices all(graph.cells().size());
  std::iota(all.begin(), all.end(), 0);
  Indices slice(all.size(), 0);
  std::vector<FreeSheet> sheets;
  for (const Indices& connected : graph.FindParts(all, slice)) {
    const std::vector<double> cuts = FindCuts(graph.cells(), connected);
    for (const int index : connected) {
      const double height = static_cast<double>(graph.cells()[static_cast<size_t>(index)].height);
      slice[static_cast<size_t>(index)] =
          static_cast<int>(std::upper_bound(cuts.begin(), cuts.end(), height) - cuts.begin());
    }
    for (Indices& part : graph.FindParts(connected, slice))
      if (static_cast<double>(part.size()) * surface.cell_size * surface.cell_size >=
          options.min_area)
        sheets.push_back(MakeSheet(graph.cells(), std::move(part), surface.cell_size));
  }
  std::stable_sort(sheets.begin(), sheets.end(), [](const FreeSheet& a, const FreeSheet& b) {
    return a.mean_height < b.mean_height;
  });
  int level = 0;
  double level_height = sheets.empty() ? 0 : sheets.front().mean_height;
  for (FreeSheet& sheet : sheets) {
    if (sheet.mean_height - level_height > options.deck_height) {
      ++level;
      level_height = sheet.mean_height;
    }
    sheet.level = level;
  }
  return sheets;
}

int LevelAt(double height, std::span<const FreeSheet> sheets) {
  int level = 0;
  double best = 1e9;
  for (const FreeSheet& sheet : sheets) {
    const bool is_within =
        height > sheet.min_height - kSheetSlack && height < sheet.max_height + kSheetSlack;
    const double distance = std::abs(height - sheet.mean_height) + (is_within ? 0 : 1e6);
    if (distance < best) best = distance, level = sheet.level;
  }
  return level;
}

std::string EncodeFreeSpaceGeoJson(const std::vector<FreeSheet>& sheets,
                                   const std::optional<SiteDatum>& datum) {
  std::vector<std::string> features;
  for (const FreeSheet& sheet : sheets) {
    char properties[256];
    std::snprintf(
        properties, sizeof properties,
        R"({"level":%d,"area_m2":%.3f,"min_height_m":%.3f,"max_height_m":%.3f,"mean_height_m":%.3f})",
        sheet.level, sheet.area, sheet.min_height, sheet.max_height, sheet.mean_height);
    features.push_back(R"({"type":"Feature","properties":)" + std::string(properties) +
                       R"(,"geometry":{"type":"Polygon","coordinates":)" +
                       FormatPolygon(sheet.rings, datum) + "}}");
  }
  return FormatFeatureCollection(features, datum);
}

}  // namespace parkade
