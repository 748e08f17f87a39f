#pragma once

#include <string>
#include <vector>

namespace parkade {

/// server/http/openapi.json, the description of what exists.
const std::string& OpenApiText();

/// Methods that `path` has according to the description, in upper case; none
/// when there is no such path. For telling 405 from 404.
std::vector<std::string> MethodsOf(const std::string& path);

}  // namespace parkade
