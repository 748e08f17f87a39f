#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace parkade {

/// Constants of a network.
struct OnnxTensor {
  std::vector<std::int64_t> sizes;  ///< none: one number
  std::vector<float> values;
};

/// One operation: the attributes that are integers or text.
struct OnnxNode {
  std::string operation;  ///< "Conv", ...
  std::vector<std::string> inputs, outputs;
  std::map<std::string, std::vector<std::int64_t>, std::less<>> numbers;
  std::map<std::string, std::string, std::less<>> words;

  /// Those of an attribute, or `otherwise` where the file does not have it.
  std::vector<std::int64_t> Numbers(std::string_view name,
                                    const std::vector<std::int64_t>& otherwise) const;
};

/// A network of one input and one output; each node comes after those whose outputs it takes.
struct OnnxGraph {
  std::vector<OnnxNode> nodes;                             ///< without constants
  std::map<std::string, OnnxTensor, std::less<>> tensors;  ///< by name: weights and constants
  std::string input, output;

  /// Nothing where there is no such tensor.
  const OnnxTensor* FindTensor(std::string_view name) const;
};

/// Reads ONNX with tensors of floats as raw bytes, which is how PyTorch writes it; nothing where
/// the file is something else.
std::optional<OnnxGraph> ReadOnnxGraph(std::string_view model);

}  // namespace parkade
