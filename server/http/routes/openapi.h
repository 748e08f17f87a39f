#pragma once

#include <string>

namespace parkade {

/// The text of server/http/openapi.json, which describes all routes.
const std::string& OpenApiText();

}  // namespace parkade
