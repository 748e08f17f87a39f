#include "export/surface_parts.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <unordered_map>
#include <unordered_set>

#include "core/files/for_each_releasing.h"
#include "core/math/fast_floor.h"
#include "export/geojson.h"

namespace parkade {
namespace {

constexpr double kSquareSize = 0.2;  // [m], about
constexpr float kDeckStep = 0.5F;    // [m] of height in a square: more are two decks
constexpr float kMaxStep = 0.3F;     // [m] between neighbors of one part
constexpr double kMinArea = 0.5;     // [m^2]
constexpr int kLeastShare = 4;       // of a square one in so many cells must be known

/// Cells of one square and deck.
struct Square {
  int x = 0, y = 0;
  float height_sum = 0;
  int count = 0;
  std::array<int, kNumSurfaceClasses + 1> classes{};

  float height() const { return height_sum / static_cast<float>(count); }
  SurfaceClass surface() const {
    return static_cast<SurfaceClass>(std::max_element(classes.begin(), classes.end()) -
                                     classes.begin());
  }
};

/// Squares of a surface by place, and their parts.
class SquareGraph {
 public:
  SquareGraph(const SurfaceMap& surface, int factor) {
    ForEachReleasing(surface.cells, [&](size_t i) { Add(surface.cells[i], factor); });
    for (std::size_t i = 0; i < squares_.size(); ++i) {
      const SurfaceClass found = squares_[i].surface();
      is_open_.push_back(found != SurfaceClass::kUnknown && !IsForCars(found) &&
                         kLeastShare * squares_[i].count >= factor * factor);
    }
  }

  /// The next part, as cells of the squares' size; nothing after the last.
  std::optional<std::pair<SurfaceClass, std::vector<SurfaceCell>>> NextPart() {
    while (seed_ < squares_.size() && !is_open_[seed_]) ++seed_;
    if (seed_ == squares_.size()) return std::nullopt;
    const SurfaceClass surface = squares_[seed_].surface();
    std::vector<std::size_t> part{seed_};
    std::unordered_set<std::int64_t> places{KeyOf(squares_[seed_])};
    is_open_[seed_] = false;
    for (std::size_t i = 0; i < part.size(); ++i)
      for (const auto& [dx, dy] : {std::pair(1, 0), {0, 1}, {-1, 0}, {0, -1}}) {
        const Square& from = squares_[part[i]];
        for (const std::size_t next : At(from.x + dx, from.y + dy)) {
          const bool is_near = std::abs(squares_[next].height() - from.height()) <= kMaxStep;
          if (!is_open_[next] || !is_near || squares_[next].surface() != surface) continue;
          if (!places.insert(KeyOf(squares_[next])).second) continue;
          is_open_[next] = false;
          part.push_back(next);
        }
      }
    std::vector<SurfaceCell> cells;
    cells.reserve(part.size());
    for (const std::size_t i : part)
      cells.push_back({.x = squares_[i].x, .y = squares_[i].y, .height = squares_[i].height()});
    std::sort(cells.begin(), cells.end(), [](const SurfaceCell& a, const SurfaceCell& b) {
      return CellKey(a.x, a.y) < CellKey(b.x, b.y);
    });
    return std::pair(surface, std::move(cells));
  }

 private:
  static std::int64_t KeyOf(const Square& square) { return CellKey(square.x, square.y); }

  std::span<const std::size_t> At(int x, int y) const {
    const auto found = at_.find(CellKey(x, y));
    return found == at_.end() ? std::span<const std::size_t>() : std::span(found->second);
  }

  void Add(const SurfaceCell& cell, int factor) {
    const int x = FloorDivide(cell.x, factor), y = FloorDivide(cell.y, factor);
    std::vector<std::size_t>& here = at_[CellKey(x, y)];
    auto found = std::find_if(here.begin(), here.end(), [&](std::size_t i) {
      return std::abs(squares_[i].height() - cell.height) <= kDeckStep;
    });
    if (found == here.end()) {
      found = here.insert(here.end(), squares_.size());
      squares_.push_back({.x = x, .y = y});
    }
    Square& square = squares_[*found];
    square.height_sum += cell.height;
    ++square.count;
    ++square.classes[static_cast<std::size_t>(cell.Surface())];
  }

  std::vector<Square> squares_;
  std::unordered_map<std::int64_t, std::vector<std::size_t>> at_;
  std::vector<bool> is_open_;  ///< in no part yet
  std::size_t seed_ = 0;
};

}  // namespace

std::vector<SurfacePart> FindSurfaceParts(const SurfaceMap& surface) {
  const int factor = std::max(1, static_cast<int>(std::lround(kSquareSize / surface.cell_size)));
  const double size = factor * surface.cell_size;
  SquareGraph graph(surface, factor);
  std::vector<SurfacePart> parts;
  while (const auto found = graph.NextPart()) {
    const auto& [kind, cells] = *found;
    SurfacePart part;
    part.surface = kind;
    part.area = size * size * static_cast<double>(cells.size());
    if (part.area < kMinArea) continue;
    for (const SurfaceCell& cell : cells)
      part.mean_height += static_cast<double>(cell.height) / static_cast<double>(cells.size());
    part.rings = TraceBoundary(cells, size);
    parts.push_back(std::move(part));
  }
  return parts;
}

std::string EncodeSurfacesGeoJson(const std::vector<SurfacePart>& parts,
                                  std::span<const FreeSheet> sheets,
                                  const std::optional<SiteDatum>& datum) {
  std::vector<std::string> features;
  for (const SurfacePart& part : parts) {
    char properties[160];
    std::snprintf(properties, sizeof properties,
                  R"({"surface":"%s","level":%d,"area_m2":%.2f,"mean_height_m":%.3f})",
                  NameOf(part.surface).data(), LevelAt(part.mean_height, sheets), part.area,
                  part.mean_height);
    features.push_back(R"({"type":"Feature","properties":)" + std::string(properties) +
                       R"(,"geometry":{"type":"Polygon","coordinates":)" +
                       FormatPolygon(part.rings, datum) + "}}");
  }
  return FormatFeatureCollection(features, datum);
}

}  // namespace parkade
