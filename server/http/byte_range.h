#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace parkade {

/// A part of a file, RFC 9110 section 14: `length` bytes from `first`.
struct ByteRange {
  std::int64_t first = 0;
  std::int64_t length = 0;
};

/// The part of a file of `size` bytes that a Range field asks for; a last byte
/// beyond the end is moved to the end. Nothing when the field is to be ignored:
/// another unit than bytes, or not a range. Throws HttpError{416} when no byte
/// of the range exists, or for more than one range.
std::optional<ByteRange> ParseByteRange(const std::string& field, std::int64_t size);

}  // namespace parkade
