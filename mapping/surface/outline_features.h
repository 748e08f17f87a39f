#pragma once

#include <opencv2/core/mat.hpp>
#include <span>

#include "mapping/surface/deck_rasters.h"

namespace parkade {

constexpr int kOutlineFactor = 2;     ///< cells per pixel of the features
constexpr int kOutlineFeatures = 15;  ///< per pixel

/// What a network that draws outlines is told of a window of a deck: 1 x kOutlineFeatures x height
/// x width (CV_32F), a pixel per kOutlineFactor x kOutlineFactor cells; all 0 where nothing was
/// seen, and off the deck. \param window  in pixels, from the deck's origin
cv::Mat OutlineFeatures(std::span<const SurfacePainter::PaintedCell> cells, const DeckRaster& deck,
                        const cv::Rect& window);

/// The whole deck, in pixels.
cv::Rect OutlineWindow(const DeckRaster& deck);

}  // namespace parkade
