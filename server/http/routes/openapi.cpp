#include "server/http/routes/openapi.h"

#include "openapi_json.h"  // made of openapi.json by CMake

namespace parkade {

const std::string& OpenApiText() {
  static const std::string text = kOpenApiJson;
  return text;
}

}  // namespace parkade
