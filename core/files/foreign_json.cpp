#include "core/files/foreign_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace parkade {
namespace {

constexpr int kMaxDepth = 64;

/// How many brackets are open at once, at most; those in strings do not count. The parser's own
/// callback would tell as well, but takes the square of the time for many siblings.
int DepthOf(std::string_view text) {
  int depth = 0, deepest = 0;
  bool is_in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_in_string) {
      if (c == '\\') ++i;
      is_in_string = c != '"';
    } else if (c == '"') {
      is_in_string = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

}  // namespace

nlohmann::json ParseForeignJson(std::string_view text) {
  if (DepthOf(text) > kMaxDepth) return nlohmann::json::value_t::discarded;
  return nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
}

}  // namespace parkade
