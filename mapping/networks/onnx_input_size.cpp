#include "mapping/networks/onnx_input_size.h"

#include <cstdint>
#include <vector>

namespace parkade {
namespace {

// Field numbers of onnx.proto.
constexpr std::uint64_t kModelGraph = 7, kGraphInput = 11, kValueType = 2, kTypeTensor = 1,
                        kTensorShape = 2, kShapeDimension = 1, kDimensionValue = 1;
constexpr std::uint64_t kMaxSide = 16384;  // [px]

/// One field of a protocol buffer message: a number, or the bytes of text or of another message.
struct Field {
  std::uint64_t key = 0;
  std::uint64_t number = 0;
  std::string_view bytes;
};

/// Reads the fields of one message in order; ends early where its bytes make no sense.
class FieldReader {
 public:
  explicit FieldReader(std::string_view message) : rest_(message) {}

  std::optional<Field> Next() {
    const std::optional<std::uint64_t> tag = Varint();
    if (!tag) return std::nullopt;
    Field field{.key = *tag >> 3, .number = 0, .bytes = {}};
    switch (*tag & 7) {
      case 0:
        if (const auto number = Varint()) return field.number = *number, field;
        return std::nullopt;
      case 1: return Take(8, field);
      case 2: {
        const auto length = Varint();
        return length ? Take(*length, field) : std::nullopt;
      }
      case 5: return Take(4, field);
      default: return std::nullopt;
    }
  }

 private:
  std::optional<std::uint64_t> Varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64 && !rest_.empty(); shift += 7) {
      const auto byte = static_cast<std::uint8_t>(rest_.front());
      rest_.remove_prefix(1);
      value |= std::uint64_t{byte & 127U} << shift;
      if (byte < 128) return value;
    }
    return std::nullopt;
  }

  std::optional<Field> Take(std::uint64_t length, Field field) {
    if (length > rest_.size()) return std::nullopt;
    field.bytes = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return field;
  }

  std::string_view rest_;
};

/// All fields `key` of a message.
std::vector<Field> FieldsOf(std::string_view message, std::uint64_t key) {
  std::vector<Field> found;
  FieldReader reader(message);
  while (const std::optional<Field> field = reader.Next())
    if (field->key == key) found.push_back(*field);
  return found;
}

/// The message in field `key`, empty where there is none.
std::string_view MessageIn(std::string_view message, std::uint64_t key) {
  const std::vector<Field> found = FieldsOf(message, key);
  return found.empty() ? std::string_view() : found.back().bytes;
}

std::uint64_t DimensionOf(const Field& dimension) {
  const std::vector<Field> value = FieldsOf(dimension.bytes, kDimensionValue);
  return value.empty() ? 0 : value.back().number;
}

}  // namespace

std::optional<cv::Size> FindOnnxInputSize(std::string_view model) {
  for (const Field& input : FieldsOf(MessageIn(model, kModelGraph), kGraphInput)) {
    const std::string_view tensor = MessageIn(MessageIn(input.bytes, kValueType), kTypeTensor);
    const std::vector<Field> shape = FieldsOf(MessageIn(tensor, kTensorShape), kShapeDimension);
    if (shape.size() != 4) continue;
    const std::uint64_t height = DimensionOf(shape[2]), width = DimensionOf(shape[3]);
    if (height == 0 || width == 0 || height > kMaxSide || width > kMaxSide) return std::nullopt;
    return cv::Size(static_cast<int>(width), static_cast<int>(height));
  }
  return std::nullopt;
}

}  // namespace parkade
