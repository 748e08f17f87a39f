#include "mapping/networks/protobuf_fields.h"

namespace parkade {

std::optional<ProtobufField> ProtobufReader::Next() {
  const std::optional<std::uint64_t> tag = Varint();
  if (!tag) return std::nullopt;
  ProtobufField field{.key = *tag >> 3, .number = 0, .bytes = {}};
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

std::optional<std::uint64_t> ProtobufReader::Varint() {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64 && !rest_.empty(); shift += 7) {
    const auto byte = static_cast<std::uint8_t>(rest_.front());
    rest_.remove_prefix(1);
    value |= std::uint64_t{byte & 127U} << shift;
    if (byte < 128) return value;
  }
  return std::nullopt;
}

std::optional<ProtobufField> ProtobufReader::Take(std::uint64_t length, ProtobufField field) {
  if (length > rest_.size()) return std::nullopt;
  field.bytes = rest_.substr(0, length);
  rest_.remove_prefix(length);
  return field;
}

std::vector<ProtobufField> FieldsOf(std::string_view message, std::uint64_t key) {
  std::vector<ProtobufField> found;
  ProtobufReader reader(message);
  while (const std::optional<ProtobufField> field = reader.Next())
    if (field->key == key) found.push_back(*field);
  return found;
}

std::string_view BytesIn(std::string_view message, std::uint64_t key) {
  const std::vector<ProtobufField> found = FieldsOf(message, key);
  return found.empty() ? std::string_view() : found.back().bytes;
}

std::uint64_t NumberIn(std::string_view message, std::uint64_t key) {
  const std::vector<ProtobufField> found = FieldsOf(message, key);
  return found.empty() ? 0 : found.back().number;
}

std::vector<std::int64_t> NumbersIn(std::string_view message, std::uint64_t key) {
  std::vector<std::int64_t> numbers;
  for (const ProtobufField& field : FieldsOf(message, key)) {
    if (field.bytes.empty()) {
      numbers.push_back(static_cast<std::int64_t>(field.number));
      continue;
    }
    ProtobufReader packed(field.bytes);
    while (const auto number = packed.Varint())
      numbers.push_back(static_cast<std::int64_t>(*number));
  }
  return numbers;
}

}  // namespace parkade
