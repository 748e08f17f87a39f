#pragma once

#include <string>
#include <vector>

namespace parkade {

/// The text of server/http/openapi.json, which describes all routes.
const std::string& OpenApiText();

/// Methods that `path` has according to the description, in upper case; none
/// when there is no such path. Tells 405 from 404.
std::vector<std::string> MethodsOf(const std::string& path);

}  // namespace parkade
