#include "server/ingest/files/column_names.h"

#include <algorithm>
#include <cctype>
#include <functional>
#include <optional>
#include <string>

namespace parkade {
namespace {

using IsName = std::function<bool(std::string_view)>;

/// In lower case.
std::string Plain(std::string_view name) {
  std::string plain;
  for (const char c : name)
    if (std::isspace(static_cast<unsigned char>(c)) == 0)
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return plain;
}

bool HoldsAny(std::string_view name, const std::vector<std::string_view>& words) {
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
    return name.find(word) != std::string_view::npos;
  });
}

bool IsTime(std::string_view name) {
  return HoldsAny(name, {"time", "stamp"}) || name == "t" || name == "ts" || name.starts_with("t_");
}

bool IsRate(std::string_view name) {
  return name.starts_with('w') || name.starts_with('g') ||
         HoldsAny(name, {"gyr", "ang", "omega", "rate"});
}

bool IsAcceleration(std::string_view name) {
  return HoldsAny(name, {"acc"}) || (name.starts_with('a') && !IsRate(name));
}

IsName Along(char axis, bool (*is_kind)(std::string_view)) {
  return [=](std::string_view name) { return name.ends_with(axis) && is_kind(name); };
}

IsName Holding(const std::vector<std::string_view>& words) {
  return [=](std::string_view name) { return HoldsAny(name, words); };
}

bool IsSideways(std::string_view name) { return name.ends_with('y') || name.ends_with('z'); }

/// What the columns of EuRoC's order may be called.
std::vector<IsName> NamesOf(TableKind kind) {
  switch (kind) {
    case TableKind::kImu:
      return {IsTime,
              Along('x', IsRate),
              Along('y', IsRate),
              Along('z', IsRate),
              Along('x', IsAcceleration),
              Along('y', IsAcceleration),
              Along('z', IsAcceleration)};
    case TableKind::kWheels:
      return {IsTime,
              [](std::string_view name) {
                return (name.starts_with('v') && !IsSideways(name)) || HoldsAny(name, {"speed"});
              },
              [](std::string_view name) {
                return (IsRate(name) && !name.ends_with('x') && !name.ends_with('y')) ||
                       HoldsAny(name, {"yaw"});
              }};
    case TableKind::kGnss:
      return {IsTime, Holding({"lat"}), Holding({"lon", "lng"}), Holding({"alt", "height"})};
    case TableKind::kImages: return {IsTime, Holding({"file", "name", "path", "image"})};
  }
  return {};
}

/// The only name of a kind.
std::optional<std::size_t> Find(const std::vector<std::string>& names, const IsName& is_name) {
  const auto found = std::find_if(names.begin(), names.end(), is_name);
  if (found == names.end() || std::find_if(found + 1, names.end(), is_name) != names.end())
    return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace

std::vector<std::size_t> ColumnsOf(const std::vector<std::string_view>& names, TableKind kind) {
  std::vector<std::string> plain;
  plain.reserve(names.size());
  for (const std::string_view name : names) plain.push_back(Plain(name));
  std::vector<std::size_t> columns;
  bool is_in_order = true;
  for (const IsName& is_name : NamesOf(kind)) {
    const std::optional<std::size_t> at = Find(plain, is_name);
    if (!at) return {};
    is_in_order = is_in_order && *at == columns.size();
    columns.push_back(*at);
  }
  if (is_in_order) return {};
  // Sigmas follow, where the table has them.
  if (kind == TableKind::kGnss)
    for (const char axis : {'e', 'n', 'u'}) {
      const std::optional<std::size_t> sigma = Find(plain, [=](std::string_view name) {
        return name.starts_with("s") && name.ends_with(std::string("_") + axis);
      });
      if (!sigma) break;
      columns.push_back(*sigma);
    }
  return columns;
}

}  // namespace parkade
