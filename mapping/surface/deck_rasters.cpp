#include "mapping/surface/deck_rasters.h"

#include <Eigen/Geometry>
#include <ranges>
#include <utility>

#include "core/math/fast_floor.h"

namespace parkade {
namespace {

using PaintedCell = SurfacePainter::PaintedCell;

using Box = Eigen::AlignedBox2i;

template <typename Indices>
Box BoxAround(std::span<const PaintedCell> cells, const Indices& indices) {
  Box box;
  for (const int i : indices) {
    const SurfaceCell& cell = cells[static_cast<size_t>(i)].cell;
    box.extend(Eigen::Vector2i(cell.x, cell.y));
  }
  return box;
}

/// Where which deck has a cell already.
class Occupancy {
 public:
  explicit Occupancy(const Box& box)
      : box_(box),
        width_(static_cast<size_t>(box.sizes().x()) + 1),
        deck_(width_ * (static_cast<size_t>(box.sizes().y()) + 1), -1) {}

  /// Whether the place was free for this deck; it no longer is.
  bool Take(const SurfaceCell& cell, int deck) {
    int& owner = deck_[static_cast<size_t>(cell.y - box_.min().y()) * width_ +
                       static_cast<size_t>(cell.x - box_.min().x())];
    return std::exchange(owner, deck) != deck;
  }

 private:
  Box box_;
  size_t width_;
  std::vector<int> deck_;
};

DeckRaster RasterOf(std::span<const PaintedCell> cells, std::span<const int> members, int align) {
  const Box box = BoxAround(cells, members);
  DeckRaster deck;
  Eigen::Vector2i size;
  for (int axis = 0; axis < 2; ++axis) {
    deck.origin[axis] = align * FloorDivide(box.min()[axis], align);
    size[axis] = align * (FloorDivide(box.max()[axis], align) + 1) - deck.origin[axis];
  }
  deck.index = cv::Mat(size.y(), size.x(), CV_32SC1, cv::Scalar(-1));
  for (const int i : members) {
    const SurfaceCell& cell = cells[static_cast<size_t>(i)].cell;
    deck.index.at<int>(cell.y - deck.origin.y(), cell.x - deck.origin.x()) = i;
  }
  return deck;
}

}  // namespace

SurfaceLinks LinkPaintedCells(std::span<const PaintedCell> cells, double max_step) {
  SurfaceMap surface;
  surface.cells.reserve(cells.size());
  for (const PaintedCell& cell : cells) surface.cells.push_back(cell.cell);
  return LinkCells(surface, max_step);
}

std::vector<DeckRaster> CutIntoDecks(std::span<const PaintedCell> cells, const SurfaceLinks& links,
                                     int align, std::size_t min_cells) {
  std::vector<DeckRaster> decks;
  if (cells.empty()) return decks;
  Occupancy occupancy(BoxAround(cells, std::views::iota(0, static_cast<int>(cells.size()))));
  std::vector<bool> is_taken(cells.size());
  std::vector<int> members;
  int num_pieces = 0;
  for (size_t first = 0; first < cells.size(); ++first) {
    if (is_taken[first]) continue;
    const int piece = num_pieces++;
    const auto take = [&](int i) {
      const auto at = static_cast<size_t>(i);
      if (is_taken[at] || !occupancy.Take(cells[at].cell, piece)) return;
      is_taken[at] = true;
      members.push_back(i);
    };
    members.clear();
    take(static_cast<int>(first));
    for (size_t next = 0; next < members.size(); ++next) {
      const auto i = static_cast<size_t>(members[next]);
      for (const int neighbor : {links.left[i], links.right[i], links.down[i], links.up[i]})
        if (neighbor >= 0) take(neighbor);
    }
    if (members.size() >= min_cells) decks.push_back(RasterOf(cells, members, align));
  }
  return decks;
}

}  // namespace parkade
