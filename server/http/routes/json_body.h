#pragma once

#include <httplib.h>

#include <array>
#include <initializer_list>
#include <optional>
#include <string>

#include "server/http/json_view.h"

namespace parkade {

/// Reads the body, a JSON object of at most `max_bytes` with some of the members `known`. Throws
/// Error{kInvalidInput} for anything else. An empty body is an empty object.
Json ReadObject(const httplib::ContentReader& body, std::initializer_list<const char*> known,
                size_t max_bytes = size_t{128} << 10);

// Members of such an object; nothing where absent or null. Throw Error{kInvalidInput} where they
// are of another kind.
std::optional<std::string> TextIn(const Json& object, const char* key);
std::optional<std::int64_t> IntegerIn(const Json& object, const char* key);
std::optional<double> RealIn(const Json& object, const char* key);
std::optional<bool> FlagIn(const Json& object, const char* key);
std::optional<std::vector<std::string>> TextsIn(const Json& object, const char* key);

/// Throws Error{kInvalidInput} unless `value`, which the API calls `name`, is an object with some
/// of the members `known`.
void RequireObject(const Json& value, const std::string& name,
                   std::initializer_list<const char*> known);

/// [x, y, z]; throws Error{kInvalidInput} for anything else.
std::array<double, 3> PointOf(const Json& value);

}  // namespace parkade
