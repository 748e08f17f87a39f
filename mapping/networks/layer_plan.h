#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "mapping/networks/layer.h"
#include "mapping/networks/onnx_graph.h"

namespace parkade {

/// One layer and the buffers that it takes its images from and gives its own to.
struct LayerStep {
  std::unique_ptr<Layer> layer;
  int input = 0;
  int added = -1;  ///< -1: nothing
  int output = 0;
};

/// What is to be done for one image. The network's input is in buffer 0, its output in that of the
/// last step.
struct LayerPlan {
  int input_channels = 0;
  float input_factor = 1;       ///< what the input is to be multiplied by before
  bool is_input_dense = false;  ///< pixels of the input follow without gaps
  int num_buffers = 0;
  std::vector<LayerStep> steps;
};

/// Nothing where the network has an operation, or a combination of them, that no layer does.
std::optional<LayerPlan> PlanLayers(const OnnxGraph& graph);

}  // namespace parkade
