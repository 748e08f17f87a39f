#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"

namespace parkade {

/// A column that may be NULL.
inline std::optional<std::string> OptionalText(const Statement& row, int column) {
  if (row.IsNull(column)) return std::nullopt;
  return row.Text(column);
}

inline std::optional<std::int64_t> OptionalInteger(const Statement& row, int column) {
  if (row.IsNull(column)) return std::nullopt;
  return row.Integer(column);
}

/// The first column of all rows.
inline std::vector<std::string> Texts(Statement query) {
  std::vector<std::string> texts;
  while (query.Step()) texts.push_back(query.Text(0));
  return texts;
}

}  // namespace parkade
