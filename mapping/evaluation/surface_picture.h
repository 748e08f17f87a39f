#pragma once

#include <opencv2/core/mat.hpp>

#include "mapping/evaluation/scoped_surfaces.h"

namespace parkade {

/// What is right and wrong about an estimated surface, from above, north up, a pixel per sample
/// (CV_8UC3): gray where both are, darker within `rim_width` [m] of both outlines, orange where of
/// one alone; red what is false, blue what is missed, white where nothing counts. Of several decks
/// the uppermost is painted.
cv::Mat PaintSurfaceErrors(const ScopedSurfaces& surfaces, double rim_width,
                           const SurfaceEvaluationOptions& options);

}  // namespace parkade
