#pragma once

#include "mapping/networks/layer.h"
#include "mapping/networks/matrix_product.h"

namespace parkade {

/// One row of a depthwise convolution's output.
struct DepthwiseRow {
  const LayerImage& input;
  const float* weights = nullptr;  ///< side x side x the image's step
  int stride = 1;                  ///< [px]
  int top = 0;                     ///< row of the input where windows begin; may be off it
  int width = 0;                   ///< [px]
  float* output = nullptr;
  LayerFinish finish = {};
};

/// Windows of 3 x 3 and of 5 x 5.
void ConvolveDepthwise3(const DepthwiseRow& row);
void ConvolveDepthwise5(const DepthwiseRow& row);

}  // namespace parkade
