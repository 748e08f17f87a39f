#include "server/http/byte_range.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>

#include "server/http/problem.h"

namespace parkade {
namespace {

/// Parses a number of digits only; a number too large counts as the largest.
std::optional<std::int64_t> Digits(std::string_view text) {
  if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos)
    return std::nullopt;
  std::int64_t number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  return parsed.ec == std::errc{} ? number : std::numeric_limits<std::int64_t>::max();
}

[[noreturn]] void Refuse(const std::string& detail) {
  throw HttpError({416, "range_not_satisfiable", detail});
}

}  // namespace

std::optional<ByteRange> ParseByteRange(const std::string& field, std::int64_t size) {
  constexpr std::string_view kUnit = "bytes=";
  if (!field.starts_with(kUnit)) return std::nullopt;
  const std::string_view range = std::string_view(field).substr(kUnit.size());
  if (range.find(',') != std::string_view::npos) Refuse("one range at a time");
  const size_t dash = range.find('-');
  if (dash == std::string_view::npos) return std::nullopt;

  const std::string_view first_text = range.substr(0, dash), last_text = range.substr(dash + 1);
  const std::optional<std::int64_t> first = Digits(first_text), last = Digits(last_text);
  const std::string beyond = "the range lies beyond the file's " + std::to_string(size) + " bytes";
  if (first_text.empty()) {
    if (!last) return std::nullopt;
    if (*last == 0 || size == 0) Refuse(beyond);
    const std::int64_t length = std::min(*last, size);
    return ByteRange{size - length, length};
  }
  if (!first || (!last && !last_text.empty())) return std::nullopt;
  if (last && *last < *first) return std::nullopt;
  if (*first >= size) Refuse(beyond);
  const std::int64_t end = std::min(last.value_or(size - 1), size - 1);
  return ByteRange{*first, end - *first + 1};
}

}  // namespace parkade
