#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace parkade {

/// One field of a protocol buffer message: a number, or the bytes of text, of another message or of
/// a packed list.
struct ProtobufField {
  std::uint64_t key = 0;
  std::uint64_t number = 0;
  std::string_view bytes;
};

/// Reads the fields of one message in order; ends early where its bytes make no sense.
class ProtobufReader {
 public:
  explicit ProtobufReader(std::string_view message) : rest_(message) {}

  std::optional<ProtobufField> Next();

  /// The next number of a packed list.
  std::optional<std::uint64_t> Varint();

 private:
  std::optional<ProtobufField> Take(std::uint64_t length, ProtobufField field);

  std::string_view rest_;
};

/// All fields `key` of a message.
std::vector<ProtobufField> FieldsOf(std::string_view message, std::uint64_t key);

/// The bytes of field `key`, empty where there is none; of several the last, as the format has it.
std::string_view BytesIn(std::string_view message, std::uint64_t key);

/// The number of field `key`, 0 where there is none.
std::uint64_t NumberIn(std::string_view message, std::uint64_t key);

/// All numbers of field `key`, packed or not.
std::vector<std::int64_t> NumbersIn(std::string_view message, std::uint64_t key);

}  // namespace parkade
