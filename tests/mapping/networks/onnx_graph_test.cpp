#include "mapping/networks/onnx_graph.h"

#include <gtest/gtest.h>

#include "mapping/networks/onnx_input_size.h"
#include "mapping/networks/protobuf_fields.h"
#include "tests/mapping/worlds/tiny_onnx.h"

namespace parkade {
namespace {

TEST(OnnxGraph, HasNodesAttributesAndTensors) {
  const OnnxGraph graph = ReadOnnxGraph(TinyOnnx({1, 2, 3, 4, 5, 6}, {7, 8}, 32, 16)).value();

  EXPECT_EQ(graph.input, "image");
  EXPECT_EQ(graph.output, "log_odds");
  ASSERT_EQ(graph.nodes.size(), 1);
  const OnnxNode& node = graph.nodes[0];
  EXPECT_EQ(node.operation, "Conv");
  EXPECT_EQ(node.inputs, (std::vector<std::string>{"image", "weights", "biases"}));
  EXPECT_EQ(node.outputs, std::vector<std::string>{"log_odds"});
  EXPECT_EQ(node.Numbers("kernel_shape", {}), (std::vector<std::int64_t>{1, 1}));
  EXPECT_EQ(node.Numbers("strides", {1}), std::vector<std::int64_t>{1}) << "not in the file";
  ASSERT_NE(graph.FindTensor("weights"), nullptr);
  EXPECT_EQ(graph.FindTensor("weights")->sizes, (std::vector<std::int64_t>{2, 3, 1, 1}));
  EXPECT_EQ(graph.FindTensor("weights")->values, (std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(graph.FindTensor("biases")->values, (std::vector<float>{7, 8}));
  EXPECT_EQ(graph.FindTensor("image"), nullptr);
}

TEST(OnnxGraph, CutShortItIsNone) {
  const std::string model = TinyOnnx({1, 2, 3}, {4}, 32, 16);
  for (size_t length = 0; length < model.size() - 6; ++length)
    EXPECT_FALSE(ReadOnnxGraph(model.substr(0, length))) << length;
}

TEST(OnnxInputSize, IsThatOfTheFileUnlessItLeavesItOpen) {
  EXPECT_EQ(FindOnnxInputSize(TinyOnnx({1, 2, 3}, {4}, 32, 16)), cv::Size(32, 16));
  EXPECT_EQ(FindOnnxInputSize(TinyOnnx({1, 2, 3}, {4}, 0, 0)), std::nullopt);
}

TEST(ProtobufFields, NumbersMayBePackedOrNot) {
  const std::string_view apart("\x08\x05\x08\xac\x02", 5), packed("\x0a\x03\x05\xac\x02", 5);

  EXPECT_EQ(NumbersIn(apart, 1), (std::vector<std::int64_t>{5, 300}));
  EXPECT_EQ(NumbersIn(packed, 1), (std::vector<std::int64_t>{5, 300}));
  EXPECT_EQ(NumberIn(apart, 1), 300U) << "the last counts";
  EXPECT_EQ(NumberIn(apart, 2), 0U);
  EXPECT_EQ(BytesIn(packed, 1), "\x05\xac\x02");
}

}  // namespace
}  // namespace parkade
