#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "mapping/ground/surface_links.h"
#include "mapping/surface/surface_painter.h"

namespace parkade {

/// Cells that hang together on one deck, none above another, as an image.
struct DeckRaster {
  Eigen::Vector2i origin =
      Eigen::Vector2i::Zero();  ///< (x, y) of the cell in column 0, row 0; multiples of `align`
  cv::Mat index;                ///< CV_32SC1: of the cell at (origin + (column, row)), or -1
};

/// LinkCells of painted cells.
SurfaceLinks LinkPaintedCells(std::span<const SurfacePainter::PaintedCell> cells, double max_step);

/// Cells and their neighbors on the same deck (LinkCells) -> decks of `min_cells` at least. Width
/// and height are multiples of `align` cells as well. A deck that winds above itself is cut.
/// O(cells + area of their bounding box).
std::vector<DeckRaster> CutIntoDecks(std::span<const SurfacePainter::PaintedCell> cells,
                                     const SurfaceLinks& links, int align, std::size_t min_cells);

}  // namespace parkade
