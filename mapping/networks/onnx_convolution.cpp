#include "mapping/networks/onnx_convolution.h"

#include <algorithm>

namespace parkade {
namespace {

constexpr std::int64_t kMaxChannels = 4096, kMaxSide = 31;

/// The one number that an attribute has over and over; nothing where there are different ones.
std::optional<std::int64_t> SameNumber(const OnnxNode& node, std::string_view name,
                                       std::int64_t otherwise) {
  const std::vector<std::int64_t> numbers = node.Numbers(name, {otherwise});
  const bool is_same = std::all_of(numbers.begin(), numbers.end(),
                                   [&](std::int64_t number) { return number == numbers.front(); });
  return is_same ? std::optional(numbers.front()) : std::nullopt;
}

/// Whether it is one that Convolution can be, of weights of these sizes.
bool IsKnown(const OnnxNode& node, const std::vector<std::int64_t>& sizes) {
  if (sizes.size() != 4 || sizes[2] != sizes[3] || sizes[2] % 2 == 0 || sizes[2] > kMaxSide)
    return false;
  if (sizes[0] < 1 || sizes[0] > kMaxChannels || sizes[1] < 1 || sizes[1] > kMaxChannels)
    return false;
  const std::optional<std::int64_t> group = SameNumber(node, "group", 1);
  const bool is_depthwise = group == sizes[0] && sizes[1] == 1 && (sizes[2] == 3 || sizes[2] == 5);
  const std::optional<std::int64_t> stride = SameNumber(node, "strides", 1);
  return !node.words.contains("auto_pad") && SameNumber(node, "dilations", 1) == 1 &&
         SameNumber(node, "pads", 0) == sizes[2] / 2 && (stride == 1 || stride == 2) &&
         (group == 1 || is_depthwise);
}

}  // namespace

std::optional<Convolution> ReadConvolution(const OnnxGraph& graph, const OnnxNode& node) {
  if (node.inputs.size() != 3) return std::nullopt;
  const OnnxTensor* weights = graph.FindTensor(node.inputs[1]);
  const OnnxTensor* bias = graph.FindTensor(node.inputs[2]);
  if (weights == nullptr || bias == nullptr || !IsKnown(node, weights->sizes) ||
      bias->sizes != std::vector{weights->sizes[0]})
    return std::nullopt;
  Convolution convolution;
  convolution.is_depthwise = SameNumber(node, "group", 1) != 1;
  convolution.outputs = static_cast<int>(weights->sizes[0]);
  convolution.inputs =
      convolution.is_depthwise ? convolution.outputs : static_cast<int>(weights->sizes[1]);
  convolution.side = static_cast<int>(weights->sizes[2]);
  convolution.stride = static_cast<int>(*SameNumber(node, "strides", 1));
  convolution.weights = weights->values;
  convolution.bias = bias->values;
  return convolution;
}

}  // namespace parkade
