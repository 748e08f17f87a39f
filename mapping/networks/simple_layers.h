#pragma once

#include <memory>

#include "mapping/networks/layer.h"

namespace parkade {

/// Twice as large, bilinear, between centers of pixels.
std::unique_ptr<Layer> MakeDoublingLayer();

/// Times a factor; adds nothing.
std::unique_ptr<Layer> MakeScaleLayer(float factor);

/// The hyperbolic tangent; adds nothing.
std::unique_ptr<Layer> MakeTanhLayer();

}  // namespace parkade
