#include "server/store/tables/site_scope.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace parkade {

bool Includes(const SiteScope& scope, const std::string& site) {
  return !scope || std::find(scope->begin(), scope->end(), site) != scope->end();
}

std::optional<std::string> JsonOf(const SiteScope& scope) {
  if (!scope) return std::nullopt;
  return nlohmann::json(*scope).dump();
}

SiteScope SiteScopeFromJson(const std::optional<std::string>& json) {
  if (!json) return std::nullopt;
  return nlohmann::json::parse(*json).get<std::vector<std::string>>();
}

}  // namespace parkade
