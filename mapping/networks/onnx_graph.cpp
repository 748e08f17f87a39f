#include "mapping/networks/onnx_graph.h"

#include <bit>
#include <cstring>

#include "mapping/networks/protobuf_fields.h"

namespace parkade {
namespace {

static_assert(std::endian::native == std::endian::little, "ONNX is, too");

// Field numbers of onnx.proto.
constexpr std::uint64_t kModelGraph = 7;
constexpr std::uint64_t kGraphNode = 1, kGraphTensor = 5, kGraphInput = 11, kGraphOutput = 12;
constexpr std::uint64_t kNodeInput = 1, kNodeOutput = 2, kNodeOperation = 4, kNodeAttribute = 5;
constexpr std::uint64_t kAttributeName = 1, kAttributeNumber = 3, kAttributeText = 4,
                        kAttributeTensor = 5, kAttributeNumbers = 8;
constexpr std::uint64_t kTensorSizes = 1, kTensorType = 2, kTensorName = 8, kTensorBytes = 9;
constexpr std::uint64_t kValueName = 1;
constexpr std::uint64_t kFloat = 1;  // a tensor's type

std::vector<std::string> TextsIn(std::string_view message, std::uint64_t key) {
  std::vector<std::string> texts;
  for (const ProtobufField& field : FieldsOf(message, key)) texts.emplace_back(field.bytes);
  return texts;
}

/// Nothing where the bytes are not as many floats as the sizes say.
std::optional<OnnxTensor> ReadTensor(std::string_view message) {
  OnnxTensor tensor{.sizes = NumbersIn(message, kTensorSizes), .values = {}};
  const std::string_view bytes = BytesIn(message, kTensorBytes);
  std::size_t count = 1;
  for (const std::int64_t size : tensor.sizes) {
    if (size < 0 || static_cast<std::size_t>(size) > bytes.size()) return std::nullopt;
    if (size > 0 && count > bytes.size() / static_cast<std::size_t>(size)) return std::nullopt;
    count *= static_cast<std::size_t>(size);
  }
  if (NumberIn(message, kTensorType) != kFloat || bytes.size() != count * sizeof(float))
    return std::nullopt;
  tensor.values.resize(count);
  if (count > 0) std::memcpy(tensor.values.data(), bytes.data(), bytes.size());
  return tensor;
}

OnnxNode ReadNode(std::string_view message) {
  OnnxNode node{.operation = std::string(BytesIn(message, kNodeOperation)),
                .inputs = TextsIn(message, kNodeInput),
                .outputs = TextsIn(message, kNodeOutput),
                .numbers = {},
                .words = {}};
  for (const ProtobufField& attribute : FieldsOf(message, kNodeAttribute)) {
    const std::string name(BytesIn(attribute.bytes, kAttributeName));
    std::vector<std::int64_t> numbers = NumbersIn(attribute.bytes, kAttributeNumbers);
    if (numbers.empty()) numbers = NumbersIn(attribute.bytes, kAttributeNumber);
    if (!numbers.empty()) node.numbers[name] = std::move(numbers);
    const std::string_view text = BytesIn(attribute.bytes, kAttributeText);
    if (!text.empty()) node.words[name] = text;
  }
  return node;
}

/// A constant's tensor, which is its only attribute; nothing where it is no tensor.
std::optional<OnnxTensor> ReadConstant(std::string_view message) {
  return ReadTensor(BytesIn(BytesIn(message, kNodeAttribute), kAttributeTensor));
}

}  // namespace

std::vector<std::int64_t> OnnxNode::Numbers(std::string_view name,
                                            const std::vector<std::int64_t>& otherwise) const {
  const auto found = numbers.find(name);
  return found == numbers.end() ? otherwise : found->second;
}

const OnnxTensor* OnnxGraph::FindTensor(std::string_view name) const {
  const auto found = tensors.find(name);
  return found == tensors.end() ? nullptr : &found->second;
}

std::optional<OnnxGraph> ReadOnnxGraph(std::string_view model) {
  OnnxGraph graph;
  const std::string_view message = BytesIn(model, kModelGraph);
  for (const ProtobufField& field : FieldsOf(message, kGraphTensor)) {
    std::optional<OnnxTensor> tensor = ReadTensor(field.bytes);
    if (!tensor) return std::nullopt;
    graph.tensors[std::string(BytesIn(field.bytes, kTensorName))] = std::move(*tensor);
  }
  for (const ProtobufField& field : FieldsOf(message, kGraphNode)) {
    OnnxNode node = ReadNode(field.bytes);
    if (node.outputs.size() != 1) return std::nullopt;
    if (node.operation != "Constant") {
      graph.nodes.push_back(std::move(node));
    } else {
      std::optional<OnnxTensor> tensor = ReadConstant(field.bytes);
      if (!tensor) return std::nullopt;
      graph.tensors[node.outputs[0]] = std::move(*tensor);
    }
  }
  const std::vector<ProtobufField> inputs = FieldsOf(message, kGraphInput),
                                   outputs = FieldsOf(message, kGraphOutput);
  if (inputs.size() != 1 || outputs.size() != 1) return std::nullopt;
  graph.input = BytesIn(inputs[0].bytes, kValueName);
  graph.output = BytesIn(outputs[0].bytes, kValueName);
  return graph;
}

}  // namespace parkade
