#include "mapping/networks/onnx_input_size.h"

#include <cstdint>
#include <vector>

#include "mapping/networks/protobuf_fields.h"

namespace parkade {
namespace {

// Field numbers of onnx.proto.
constexpr std::uint64_t kModelGraph = 7, kGraphInput = 11, kValueType = 2, kTypeTensor = 1,
                        kTensorShape = 2, kShapeDimension = 1, kDimensionValue = 1;
constexpr std::uint64_t kMaxSide = 16384;  // [px]

}  // namespace

std::optional<cv::Size> FindOnnxInputSize(std::string_view model) {
  for (const ProtobufField& input : FieldsOf(BytesIn(model, kModelGraph), kGraphInput)) {
    const std::string_view tensor = BytesIn(BytesIn(input.bytes, kValueType), kTypeTensor);
    const std::vector<ProtobufField> shape =
        FieldsOf(BytesIn(tensor, kTensorShape), kShapeDimension);
    if (shape.size() != 4) continue;
    const std::uint64_t height = NumberIn(shape[2].bytes, kDimensionValue),
                        width = NumberIn(shape[3].bytes, kDimensionValue);
    if (height == 0 || width == 0 || height > kMaxSide || width > kMaxSide) return std::nullopt;
    return cv::Size(static_cast<int>(width), static_cast<int>(height));
  }
  return std::nullopt;
}

}  // namespace parkade
