#include "core/files/foreign_json.h"

#include <nlohmann/json.hpp>

namespace parkade {

nlohmann::json ParseForeignJson(std::string_view text) {
  constexpr int kMaxDepth = 64;
  bool is_shallow = true;
  const auto keeps = [&](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
    is_shallow = is_shallow && depth <= kMaxDepth;
    return is_shallow;
  };
  nlohmann::json json = nlohmann::json::parse(text, keeps, /*allow_exceptions=*/false);
  return is_shallow ? json : nlohmann::json(nlohmann::json::value_t::discarded);
}

}  // namespace parkade
