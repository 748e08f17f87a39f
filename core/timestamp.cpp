#include "core/timestamp.h"

#include <cctype>
#include <cmath>
#include <cstdio>

#include "core/error.h"

namespace parkade {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

}  // namespace

Timestamp TimestampFromSeconds(double seconds) {
  // Whole seconds first: a double holds an epoch time to 200 ns only.
  const double whole = std::floor(seconds);
  return {static_cast<std::int64_t>(whole) * kNsPerSecond +
          static_cast<std::int64_t>(std::llround((seconds - whole) * 1e9))};
}

Timestamp operator+(Timestamp time, double seconds) {
  return {time.ns + TimestampFromSeconds(seconds).ns};
}

std::string ToDecimalSeconds(Timestamp time) {
  const bool is_negative = time.ns < 0;
  // Unsigned arithmetic: the magnitude of the smallest int64 has no int64.
  const std::uint64_t magnitude =
      is_negative ? 0 - static_cast<std::uint64_t>(time.ns) : static_cast<std::uint64_t>(time.ns);
  char text[40];
  std::snprintf(text, sizeof text, "%s%llu.%09llu", is_negative ? "-" : "",
                static_cast<unsigned long long>(magnitude / kNsPerSecond),
                static_cast<unsigned long long>(magnitude % kNsPerSecond));
  return text;
}

Timestamp ParseSeconds(const std::string& text) {
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  // Scientific notation loses nothing we could keep: numpy writes stamps so.
  if (text.find_first_of("eE") != std::string::npos) {
    char* end = nullptr;
    const double seconds = std::strtod(text.c_str(), &end);
    Require(
        end != text.c_str() && *end == '\0' && std::isfinite(seconds) && std::abs(seconds) < 9e9,
        ErrorCode::kInvalidInput, "'" + text + "' is not a time in seconds");
    return TimestampFromSeconds(seconds);
  }

  size_t i = 0;
  const bool is_negative = !text.empty() && text[0] == '-';
  if (is_negative || (!text.empty() && text[0] == '+')) ++i;
  std::int64_t seconds = 0;
  int num_digits = 0;
  for (; i < text.size() && is_digit(text[i]); ++i, ++num_digits) {
    Require(num_digits < 10, ErrorCode::kInvalidInput, "time '" + text + "' is out of range");
    seconds = seconds * 10 + (text[i] - '0');
  }
  Require(seconds < 9'223'372'036, ErrorCode::kInvalidInput, "time '" + text + "' is out of range");
  std::int64_t ns = 0;
  if (i < text.size() && text[i] == '.') {
    std::int64_t unit = kNsPerSecond / 10;
    for (++i; i < text.size() && is_digit(text[i]); ++i, ++num_digits) {
      ns += unit * (text[i] - '0');
      unit /= 10;
    }
  }
  Require(num_digits > 0 && i == text.size(), ErrorCode::kInvalidInput,
          "'" + text + "' is not a time in seconds");
  const std::int64_t total = seconds * kNsPerSecond + ns;
  return {is_negative ? -total : total};
}

}  // namespace parkade
