#include "export/free_space.h"

#include <algorithm>
#include <cstdio>
#include <unordered_map>
#include <unordered_set>

#include "core/error.h"

namespace parkade {
namespace {

constexpr int kNone = -1;

class SheetFinder {
 public:
  SheetFinder(const SurfaceMap& surface, const FreeSpaceOptions& options)
      : cells_(surface.cells), options_(options), is_taken_(surface.cells.size(), false) {
    for (size_t i = 0; i < cells_.size(); ++i) {
      if (static_cast<double>(cells_[i].free_belief) > options.min_belief) {
        columns_[CellKey(cells_[i].x, cells_[i].y)].push_back(static_cast<int>(i));
      } else {
        is_taken_[i] = true;
      }
    }
  }

  /// The cells of the sheet that grows from the first cell which is in none yet; empty when all are.
  std::vector<SurfaceCell> Next() {
    while (seed_ < cells_.size() && is_taken_[seed_]) ++seed_;
    std::vector<SurfaceCell> sheet;
    if (seed_ == cells_.size()) return sheet;
    std::unordered_set<std::int64_t> covered;
    const auto take = [&](int index) {
      sheet.push_back(cells_[static_cast<size_t>(index)]);
      is_taken_[static_cast<size_t>(index)] = true;
      covered.insert(CellKey(sheet.back().x, sheet.back().y));
    };
    take(static_cast<int>(seed_));
    // Breadth first, so that a winding ramp is cut straight across where the fronts meet.
    for (size_t i = 0; i < sheet.size(); ++i) {
      const SurfaceCell cell = sheet[i];
      for (const auto& [x, y] : {std::pair{cell.x + 1, cell.y}, std::pair{cell.x - 1, cell.y},
                                 std::pair{cell.x, cell.y + 1}, std::pair{cell.x, cell.y - 1}}) {
        const int next = covered.contains(CellKey(x, y)) ? kNone : FindNeighbour(cell, x, y);
        if (next != kNone) take(next);
      }
    }
    return sheet;
  }

 private:
  /// The free cell at (x, y) that is in no sheet, nearest in height and within the step.
  int FindNeighbour(const SurfaceCell& cell, int x, int y) const {
    const auto column = columns_.find(CellKey(x, y));
    if (column == columns_.end()) return kNone;
    int nearest = kNone;
    double nearest_step = options_.max_step;
    for (const int index : column->second) {
      const double step = std::abs(static_cast<double>(cells_[static_cast<size_t>(index)].height - cell.height));
      if (is_taken_[static_cast<size_t>(index)] || step > nearest_step) continue;
      nearest = index;
      nearest_step = step;
    }
    return nearest;
  }

  const std::vector<SurfaceCell>& cells_;
  const FreeSpaceOptions& options_;
  std::unordered_map<std::int64_t, std::vector<int>> columns_;  ///< free cells by (x, y)
  std::vector<bool> is_taken_;
  size_t seed_ = 0;
};

FreeSheet MakeSheet(const std::vector<SurfaceCell>& cells, double cell_size) {
  FreeSheet sheet;
  sheet.area = static_cast<double>(cells.size()) * cell_size * cell_size;
  sheet.min_height = sheet.max_height = static_cast<double>(cells[0].height);
  double sum = 0;
  for (const SurfaceCell& cell : cells) {
    const double height = static_cast<double>(cell.height);
    sheet.min_height = std::min(sheet.min_height, height);
    sheet.max_height = std::max(sheet.max_height, height);
    sum += height;
  }
  sheet.mean_height = sum / static_cast<double>(cells.size());
  sheet.rings = TraceBoundary(cells, cell_size);
  return sheet;
}

/// Text of one position, and what GeoJSON calls it: site metres, or degrees with the ellipsoidal height.
std::string FormatPosition(const Eigen::Vector3d& point, const std::optional<SiteDatum>& datum) {
  char text[128];
  if (datum) {
    const Geodetic geodetic = GeodeticFromSite(*datum, point);
    std::snprintf(text, sizeof text, "[%.9f,%.9f,%.3f]", geodetic.longitude_deg, geodetic.latitude_deg,
                  geodetic.altitude);
  } else {
    std::snprintf(text, sizeof text, "[%.3f,%.3f,%.3f]", point.x(), point.y(), point.z());
  }
  return text;
}

std::string FormatRing(const Ring& ring, const std::optional<SiteDatum>& datum) {
  std::string text = "[";
  for (const Eigen::Vector3d& point : ring) text += FormatPosition(point, datum) + ",";
  return text + FormatPosition(ring.front(), datum) + "]";  // GeoJSON repeats the first position
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
  std::vector<FreeSheet> sheets;
  SheetFinder finder(surface, options);
  for (std::vector<SurfaceCell> cells = finder.Next(); !cells.empty(); cells = finder.Next())
    if (static_cast<double>(cells.size()) * surface.cell_size * surface.cell_size >= options.min_area)
      sheets.push_back(MakeSheet(cells, surface.cell_size));

  std::stable_sort(sheets.begin(), sheets.end(),
                   [](const FreeSheet& a, const FreeSheet& b) { return a.mean_height < b.mean_height; });
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

std::string EncodeFreeSpaceGeoJson(const std::vector<FreeSheet>& sheets, const std::optional<SiteDatum>& datum) {
  std::string features;
  for (const FreeSheet& sheet : sheets) {
    char properties[256];
    std::snprintf(properties, sizeof properties,
                  R"({"level":%d,"area_m2":%.3f,"min_height_m":%.3f,"max_height_m":%.3f,"mean_height_m":%.3f})",
                  sheet.level, sheet.area, sheet.min_height, sheet.max_height, sheet.mean_height);
    std::string rings;
    for (const Ring& ring : sheet.rings) rings += (rings.empty() ? "" : ",") + FormatRing(ring, datum);
    features += std::string(features.empty() ? "\n" : ",\n") + R"({"type":"Feature","properties":)" + properties +
                R"(,"geometry":{"type":"Polygon","coordinates":[)" + rings + "]}}";
  }
  // A foreign member says what RFC 7946 has no word for: coordinates that are not WGS84.
  const std::string frame = datum ? "" : R"("frame":"site","units":"m",)";
  return R"({"type":"FeatureCollection",)" + frame + R"("features":[)" + features + "\n]}\n";
}

}  // namespace parkade
