#include "export/lanelet2/cell_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace parkade {
namespace {

/// Where a row goes in or out of one of two regions.
struct Crossing {
  int y = 0, x = 0, region = 0, change = 0;
};

template <typename Keep>
CellRegion Combine(const CellRegion& a, const CellRegion& b, const Keep& keep) {
  std::vector<Crossing> crossings;
  crossings.reserve(2 * (a.size() + b.size()));
  for (const CellRegion* region : {&a, &b})
    for (const CellSpan& span : *region) {
      const int index = region == &a ? 0 : 1;
      crossings.push_back({span.y, span.begin, index, 1});
      crossings.push_back({span.y, span.end, index, -1});
    }
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& left, const Crossing& right) {
    return std::pair(left.y, left.x) < std::pair(right.y, right.x);
  });
  CellRegion combined;
  std::array<int, 2> depth{};
  bool is_within = false;
  for (size_t i = 0; i < crossings.size(); ++i) {
    const Crossing& crossing = crossings[i];
    depth[static_cast<size_t>(crossing.region)] += crossing.change;
    const bool is_last_here = i + 1 == crossings.size() || crossings[i + 1].y != crossing.y ||
                              crossings[i + 1].x != crossing.x;
    if (!is_last_here || keep(depth[0] > 0, depth[1] > 0) == is_within) continue;
    is_within = !is_within;
    if (is_within)
      combined.push_back({crossing.y, crossing.x, crossing.x});
    else
      combined.back().end = crossing.x;
  }
  return combined;
}

int IndexOf(double coordinate, double cell_size) {
  return static_cast<int>(std::lround(coordinate / cell_size));
}

/// For each span, one of those of its piece: the same one for all of the piece.
std::vector<size_t> FindPieces(const CellRegion& region) {
  std::vector<size_t> parent(region.size());
  std::iota(parent.begin(), parent.end(), size_t{0});
  const auto root_of = [&](size_t span) {
    while (parent[span] != span) span = parent[span] = parent[parent[span]];
    return span;
  };
  size_t below = 0;  // walks along as the spans do, one row lower
  for (size_t i = 0; i < region.size(); ++i) {
    const CellSpan& span = region[i];
    while (region[below].y < span.y - 1 ||
           (region[below].y == span.y - 1 && region[below].end <= span.begin))
      ++below;
    for (size_t k = below; region[k].y == span.y - 1 && region[k].begin < span.end; ++k) {
      const size_t first = root_of(i), second = root_of(k);
      parent[std::max(first, second)] = std::min(first, second);
    }
  }
  for (size_t i = 0; i < region.size(); ++i) parent[i] = root_of(i);
  return parent;
}

}  // namespace

CellRegion FillRings(std::span<const Ring> rings, double cell_size) {
  std::map<int, std::vector<int>> columns;  // where lines go up or down, by row
  for (const Ring& ring : rings)
    for (size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector3d &from = ring[i], &to = ring[(i + 1) % ring.size()];
      const int start = IndexOf(from.y(), cell_size), end = IndexOf(to.y(), cell_size);
      for (int y = std::min(start, end); y < std::max(start, end); ++y)
        columns[y].push_back(IndexOf(from.x(), cell_size));
    }
  CellRegion region;
  for (auto& [y, crossed] : columns) {
    std::sort(crossed.begin(), crossed.end());
    for (size_t i = 0; i + 1 < crossed.size(); i += 2)
      if (crossed[i] < crossed[i + 1]) region.push_back({y, crossed[i], crossed[i + 1]});
  }
  return region;
}

CellRegion FillTouched(std::span<const Eigen::Vector2d> polygon, double cell_size) {
  struct Reach {
    double min = std::numeric_limits<double>::infinity(), max = -min;
  };
  std::map<int, Reach> rows;
  for (size_t i = 0; i < polygon.size(); ++i) {
    Eigen::Vector2d low = polygon[i] / cell_size,
                    high = polygon[(i + 1) % polygon.size()] / cell_size;
    if (low.y() > high.y()) std::swap(low, high);
    const auto x_at = [&](double y) {
      const double share = (y - low.y()) / (high.y() - low.y());
      return low.x() + share * (high.x() - low.x());
    };
    // A point on a line between rows touches both.
    const int first = static_cast<int>(std::ceil(low.y())) - 1;
    const int last = static_cast<int>(std::floor(high.y()));
    for (int y = first; y <= last; ++y) {
      Reach& reach = rows[y];
      for (const double x :
           {low.y() < y ? x_at(y) : low.x(), high.y() > y + 1 ? x_at(y + 1) : high.x()}) {
        reach.min = std::min(reach.min, x);
        reach.max = std::max(reach.max, x);
      }
    }
  }
  CellRegion region;
  for (const auto& [y, reach] : rows)
    region.push_back({y, static_cast<int>(std::ceil(reach.min)) - 1,
                      static_cast<int>(std::floor(reach.max)) + 1});
  return region;
}

CellRegion Unite(const CellRegion& a, const CellRegion& b) {
  return Combine(a, b, [](bool in_a, bool in_b) { return in_a || in_b; });
}

CellRegion Subtract(const CellRegion& a, const CellRegion& b) {
  return Combine(a, b, [](bool in_a, bool in_b) { return in_a && !in_b; });
}

CellRegion Intersect(const CellRegion& a, const CellRegion& b) {
  return Combine(a, b, [](bool in_a, bool in_b) { return in_a && in_b; });
}

long CountCells(const CellRegion& region) {
  return std::accumulate(region.begin(), region.end(), 0L, [](long sum, const CellSpan& span) {
    return sum + span.end - span.begin;
  });
}

std::vector<CellRegion> SplitIntoPieces(const CellRegion& region) {
  const std::vector<size_t> root_of = FindPieces(region);
  std::map<size_t, CellRegion> pieces;
  for (size_t i = 0; i < region.size(); ++i) pieces[root_of[i]].push_back(region[i]);
  std::vector<CellRegion> list;
  list.reserve(pieces.size());
  for (auto& [root, piece] : pieces) list.push_back(std::move(piece));
  return list;
}

std::vector<Ring> TraceBoundary(const CellRegion& region, double cell_size) {
  FileBackedVector<SurfaceCell> cells;
  cells.reserve(static_cast<size_t>(CountCells(region)));
  for (const CellSpan& span : region)
    for (int x = span.begin; x < span.end; ++x) cells.push_back({.x = x, .y = span.y});
  return TraceBoundary(std::span<const SurfaceCell>(cells), cell_size);
}

}  // namespace parkade
