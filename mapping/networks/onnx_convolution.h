#pragma once

#include <optional>

#include "mapping/networks/convolution.h"
#include "mapping/networks/onnx_graph.h"

namespace parkade {

/// What a node "Conv" says; nothing where it is one that Convolution cannot be.
std::optional<Convolution> ReadConvolution(const OnnxGraph& graph, const OnnxNode& node);

}  // namespace parkade
