#pragma once

#include <optional>
#include <string>
#include <vector>

namespace parkade {

/// The sites that somebody may know of; nothing: all.
using SiteScope = std::optional<std::vector<std::string>>;

bool Includes(const SiteScope& scope, const std::string& site);

/// A list in JSON, for a column or `json_each` of a query; nothing for all.
std::optional<std::string> JsonOf(const SiteScope& scope);
SiteScope SiteScopeFromJson(const std::optional<std::string>& json);

}  // namespace parkade
