#include "server/ingest/files/stamp_text.h"

#include <array>
#include <charconv>
#include <chrono>
#include <cmath>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr std::array kFinestFirst = {StampUnit::kNanoseconds, StampUnit::kMicroseconds,
                                     StampUnit::kMilliseconds, StampUnit::kSeconds};

/// The power of ten that a unit is in nanoseconds.
int ExponentOf(StampUnit unit) { return 3 * static_cast<int>(unit); }

double SecondsOf(StampUnit unit) { return std::pow(10, ExponentOf(unit) - 9); }

/// A decimal number as `digits` times ten to the power of `exponent`.
struct Decimal {
  std::int64_t digits = 0;
  int exponent = 0;
};

std::optional<Decimal> ParseDecimal(std::string_view text) {
  constexpr std::int64_t kEnough = 900'000'000'000'000'000;  // ten times that overflows
  Decimal number;
  const bool is_negative = text.starts_with('-');
  if (is_negative || text.starts_with('+')) text.remove_prefix(1);
  bool has_digit = false, has_point = false;
  while (!text.empty()) {
    const char c = text.front();
    if (c == '.' && !has_point) {
      has_point = true;
    } else if (c >= '0' && c <= '9') {
      has_digit = true;
      const bool fits = number.digits < kEnough;
      if (fits) number.digits = 10 * number.digits + (c - '0');
      number.exponent += (has_point ? -1 : 0) + (fits ? 0 : 1);
    } else {
      break;
    }
    text.remove_prefix(1);
  }
  if (!has_digit) return std::nullopt;
  if (is_negative) number.digits = -number.digits;
  if (text.empty()) return number;
  if (text.front() != 'e' && text.front() != 'E') return std::nullopt;
  text.remove_prefix(1);
  if (text.starts_with('+')) text.remove_prefix(1);
  int exponent = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
  if (error != std::errc{} || end != text.data() + text.size() || std::abs(exponent) > 100)
    return std::nullopt;
  number.exponent += exponent;
  return number;
}

/// `number` times ten to the power of `exponent`, digits behind the point cut off.
std::optional<std::int64_t> Scaled(Decimal number, int exponent) {
  constexpr std::int64_t kLargest = INT64_MAX / 10;
  exponent += number.exponent;
  for (; exponent < 0 && number.digits != 0; ++exponent) number.digits /= 10;
  for (; exponent > 0 && number.digits != 0; --exponent) {
    if (std::abs(number.digits) > kLargest) return std::nullopt;
    number.digits *= 10;
  }
  return number.digits;
}

/// "2011-09-26 13:02:25.964389445", perhaps with a T between and a Z behind.
std::optional<Timestamp> ParseDate(std::string_view text) {
  constexpr std::string_view kPattern = "dddd-dd-dd dd:dd:";
  if (text.ends_with('Z')) text.remove_suffix(1);
  if (text.size() <= kPattern.size()) return std::nullopt;
  for (std::size_t i = 0; i < kPattern.size(); ++i) {
    const bool is_digit = text[i] >= '0' && text[i] <= '9';
    const bool fits = kPattern[i] == 'd'   ? is_digit
                      : kPattern[i] == ' ' ? text[i] == ' ' || text[i] == 'T'
                                           : text[i] == kPattern[i];
    if (!fits) return std::nullopt;
  }
  const auto number = [&](std::size_t at, std::size_t size) {
    int value = 0;
    for (const char c : text.substr(at, size)) value = 10 * value + (c - '0');
    return value;
  };
  const auto second = ParseDecimal(text.substr(kPattern.size()));
  const auto ns = second ? Scaled(*second, 9) : std::nullopt;
  const std::chrono::year_month_day date(std::chrono::year(number(0, 4)),
                                         std::chrono::month(static_cast<unsigned>(number(5, 2))),
                                         std::chrono::day(static_cast<unsigned>(number(8, 2))));
  constexpr std::int64_t kNsPerSecond = 1'000'000'000;
  if (!ns || *ns < 0 || *ns >= 61 * kNsPerSecond || !date.ok() || number(0, 4) < 1970 ||
      number(0, 4) > 2200)
    return std::nullopt;
  const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
  const std::int64_t seconds = ((days * 24 + number(11, 2)) * 60 + number(14, 2)) * 60;
  return Timestamp{seconds * kNsPerSecond + *ns};
}

}  // namespace

const char* NameOf(StampUnit unit) {
  switch (unit) {
    case StampUnit::kNanoseconds: return "nanoseconds";
    case StampUnit::kMicroseconds: return "microseconds";
    case StampUnit::kMilliseconds: return "milliseconds";
    case StampUnit::kSeconds: break;
  }
  return "seconds";
}

std::optional<Timestamp> ParseStamp(std::string_view text, StampUnit unit) {
  const std::optional<Decimal> number = ParseDecimal(text);
  if (!number) return ParseDate(text);
  const std::optional<std::int64_t> ns = Scaled(*number, ExponentOf(unit));
  return ns ? std::optional(Timestamp{*ns}) : std::nullopt;
}

StampUnit UnitOf(const std::vector<std::string>& stamps, double min_step, double max_step) {
  constexpr double kBegin = 9.4e8, kEnd = 4.1e9;  // [s] the years 2000 to 2099
  std::vector<double> values, steps;
  bool has_point = false;
  for (const std::string& stamp : stamps) {
    const std::optional<Decimal> number = ParseDecimal(stamp);
    if (!number) continue;
    has_point = has_point || stamp.find('.') != std::string::npos;
    values.push_back(static_cast<double>(number->digits) * std::pow(10, number->exponent));
    if (values.size() < 2) continue;
    const double step = std::abs(values.back() - values[values.size() - 2]);
    if (step > 0) steps.push_back(step);
  }
  const StampUnit usual = has_point ? StampUnit::kSeconds : StampUnit::kNanoseconds;
  if (values.empty()) return usual;
  const double value = Median(std::move(values));
  const double step = steps.empty() ? 0 : Median(std::move(steps));
  const auto is_step = [&](StampUnit unit) {
    const double seconds = step * SecondsOf(unit);
    return seconds >= min_step && seconds <= max_step;
  };
  for (const StampUnit unit : kFinestFirst) {
    const double seconds = value * SecondsOf(unit);
    if (seconds >= kBegin && seconds <= kEnd && is_step(unit)) return unit;
  }
  if (has_point && is_step(StampUnit::kSeconds)) return StampUnit::kSeconds;
  for (const StampUnit unit : kFinestFirst)
    if (is_step(unit)) return unit;
  return usual;
}

}  // namespace parkade
