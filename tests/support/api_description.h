#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace parkade {

/// server/http/openapi.json.
const nlohmann::json& ApiDescription();

/// What a reference in the description leads to; `json` itself where it is none.
const nlohmann::json& Resolved(const nlohmann::json& json);

/// What keeps `value` from being as `schema` says, a schema in the API's description: a sentence
/// with the place in `value`; empty where nothing does. Objects have no members but those that are
/// described, unless none is.
std::string MismatchWith(const nlohmann::json& schema, const nlohmann::json& value);

/// The same for a schema by its name.
std::string MismatchWith(const char* name, const nlohmann::json& value);

}  // namespace parkade
