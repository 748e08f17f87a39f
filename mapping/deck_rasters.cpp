#include "mapping/deck_rasters.h"

#include <algorithm>
#include <cstdint>
#include <unordered_set>

#include "core/floor_of.h"
#include "mapping/surface_links.h"

namespace parkade {
namespace {

using PaintedCell = SurfacePainter::PaintedCell;

SurfaceMap SurfaceOf(std::span<const PaintedCell> cells) {
  SurfaceMap surface;
  surface.cells.reserve(cells.size());
  for (const PaintedCell& cell : cells) surface.cells.push_back(cell.cell);
  return surface;
}

DeckRaster RasterOf(std::span<const PaintedCell> cells, std::span<const int> members, int align) {
  Eigen::Array2i low(cells[static_cast<size_t>(members[0])].cell.x, cells[static_cast<size_t>(members[0])].cell.y);
  Eigen::Array2i high = low;
  for (const int i : members) {
    const SurfaceCell& cell = cells[static_cast<size_t>(i)].cell;
    low = low.min(Eigen::Array2i(cell.x, cell.y));
    high = high.max(Eigen::Array2i(cell.x, cell.y));
  }
  DeckRaster deck;
  for (int axis = 0; axis < 2; ++axis) {
    deck.origin[axis] = align * FloorDivide(low[axis], align);
    high[axis] = align * (FloorDivide(high[axis], align) + 1);
  }
  deck.index = cv::Mat(high[1] - deck.origin.y(), high[0] - deck.origin.x(), CV_32SC1, cv::Scalar(-1));
  for (const int i : members) {
    const SurfaceCell& cell = cells[static_cast<size_t>(i)].cell;
    deck.index.at<int>(cell.y - deck.origin.y(), cell.x - deck.origin.x()) = i;
  }
  return deck;
}

}  // namespace

std::vector<DeckRaster> CutIntoDecks(std::span<const PaintedCell> cells, double max_step, int align,
                                     std::size_t min_cells) {
  const SurfaceLinks links = LinkCells(SurfaceOf(cells), max_step);
  std::vector<DeckRaster> decks;
  std::vector<bool> is_taken(cells.size());
  for (size_t first = 0; first < cells.size(); ++first) {
    if (is_taken[first]) continue;
    std::vector<int> members = {static_cast<int>(first)};
    std::unordered_set<std::uint64_t> places;
    const auto take = [&](size_t i) {
      const SurfaceCell& cell = cells[i].cell;
      const std::uint64_t place =
          std::uint64_t{static_cast<std::uint32_t>(cell.x)} << 32U | static_cast<std::uint32_t>(cell.y);
      return is_taken[i] = places.insert(place).second;
    };
    take(first);
    for (size_t next = 0; next < members.size(); ++next) {
      const auto i = static_cast<size_t>(members[next]);
      for (const int neighbour : {links.left[i], links.right[i], links.down[i], links.up[i]})
        if (neighbour >= 0 && !is_taken[static_cast<size_t>(neighbour)] && take(static_cast<size_t>(neighbour)))
          members.push_back(neighbour);
    }
    if (members.size() >= min_cells) decks.push_back(RasterOf(cells, members, align));
  }
  return decks;
}

}  // namespace parkade
