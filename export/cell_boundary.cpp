#include "export/cell_boundary.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace parkade {
namespace {

/// East, north, west, south: a left turn is one further.
constexpr int kStepX[] = {1, 0, -1, 0};
constexpr int kStepY[] = {0, 1, 0, -1};

/// One side of a cell on the boundary, from the corner (x, y), with the cell on its left.
struct Edge {
  int x = 0, y = 0, direction = 0;
  float height = 0;  ///< of the cell
  bool is_used = false;
};

/// Sides by the key of the corner they start at: two where cells touch diagonally, else one.
using EdgeMap = std::map<std::int64_t, std::vector<Edge>>;

/// For each cell, which of its sides have no cell beyond them: a bit per side, east first. `cells`
/// sorted by (y, x).
std::vector<std::uint8_t> FindOpenSides(std::span<const SurfaceCell> cells) {
  std::vector<std::uint8_t> open(cells.size(), 15);
  const auto close = [&](size_t cell, int side) {
    open[cell] = static_cast<std::uint8_t>(open[cell] & ~(1 << side));
  };
  constexpr int kEast = 0, kNorth = 1, kWest = 2, kSouth = 3;
  size_t below = 0;  // walks along as the cells do, one row lower
  for (size_t i = 0; i < cells.size(); ++i) {
    const SurfaceCell& cell = cells[i];
    if (i > 0 && cells[i - 1].y == cell.y && cells[i - 1].x + 1 == cell.x) {
      close(i, kWest);
      close(i - 1, kEast);
    }
    const std::int64_t key = CellKey(cell.x, cell.y - 1);
    while (CellKey(cells[below].x, cells[below].y) < key) ++below;
    if (CellKey(cells[below].x, cells[below].y) != key) continue;
    close(i, kSouth);
    close(below, kNorth);
  }
  return open;
}

EdgeMap FindEdges(std::span<const SurfaceCell> cells) {
  const std::vector<std::uint8_t> open = FindOpenSides(cells);
  EdgeMap edges;
  for (size_t i = 0; i < cells.size(); ++i) {
    const SurfaceCell& cell = cells[i];
    // Counter-clockwise around the cell: its south side goes east, its east side north, ...
    constexpr int kCornerX[] = {0, 1, 1, 0};
    constexpr int kCornerY[] = {0, 0, 1, 1};
    for (int direction = 0; direction < 4; ++direction) {
      const int outwards = (direction + 3) % 4;
      if ((open[i] >> outwards & 1) == 0) continue;
      const int x = cell.x + kCornerX[direction], y = cell.y + kCornerY[direction];
      edges[CellKey(x, y)].push_back({x, y, direction, cell.height});
    }
  }
  for (auto& [key, starting] : edges)
    std::sort(starting.begin(), starting.end(),
              [](const Edge& a, const Edge& b) { return a.direction < b.direction; });
  return edges;
}

/// The edge that follows: the rightmost where two start, which keeps an enclosed hole apart from
/// the outer ring.
Edge& NextEdge(EdgeMap& edges, const Edge& edge) {
  std::vector<Edge>& starting =
      edges.at(CellKey(edge.x + kStepX[edge.direction], edge.y + kStepY[edge.direction]));
  const auto right_turns_first = [&](const Edge& a, const Edge& b) {
    return (a.direction - edge.direction + 5) % 4 < (b.direction - edge.direction + 5) % 4;
  };
  return *std::min_element(starting.begin(), starting.end(), right_turns_first);
}

Ring TraceRing(EdgeMap& edges, Edge& first, double cell_size) {
  Ring ring;
  int last_direction = -1;
  Edge* edge = &first;
  do {
    edge->is_used = true;
    if (edge->direction != last_direction)
      ring.emplace_back(edge->x * cell_size, edge->y * cell_size,
                        static_cast<double>(edge->height));
    last_direction = edge->direction;
    edge = &NextEdge(edges, *edge);
  } while (edge != &first);
  if (last_direction == first.direction)
    ring.erase(ring.begin());  // it began in the middle of a straight run
  return ring;
}

}  // namespace

std::vector<Ring> TraceBoundary(std::span<const SurfaceCell> cells, double cell_size) {
  const auto is_before = [](const SurfaceCell& a, const SurfaceCell& b) {
    return std::tie(a.y, a.x) < std::tie(b.y, b.x);
  };
  FileBackedVector<SurfaceCell> sorted;
  if (!std::is_sorted(cells.begin(), cells.end(), is_before)) {
    sorted.assign(cells.begin(), cells.end());
    std::sort(sorted.begin(), sorted.end(), is_before);
    cells = sorted;
  }
  EdgeMap edges = FindEdges(cells);
  std::vector<Ring> rings;
  // The southernmost corner of all lies on the outer ring, so that one comes first.
  for (auto& [key, starting] : edges)
    for (Edge& edge : starting)
      if (!edge.is_used) rings.push_back(TraceRing(edges, edge, cell_size));
  return rings;
}

double SignedArea(const Ring& ring) {
  double area = 0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector3d &a = ring[i], &b = ring[(i + 1) % ring.size()];
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return area;
}

}  // namespace parkade
