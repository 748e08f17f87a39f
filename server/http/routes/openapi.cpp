#include "server/http/routes/openapi.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "openapi_json.h"  // made of openapi.json by CMake

namespace parkade {
namespace {

struct Route {
  std::vector<std::string> segments;  ///< "{...}" stands for anything
  std::vector<std::string> methods;
};

std::vector<std::string> SegmentsOf(const std::string& path) {
  std::vector<std::string> segments;
  std::istringstream stream(path);
  for (std::string segment; std::getline(stream, segment, '/');) segments.push_back(segment);
  return segments;
}

std::vector<Route> ReadRoutes() {
  std::vector<Route> routes;
  const nlohmann::json description = nlohmann::json::parse(kOpenApiJson);
  for (const auto& [path, item] : description.at("paths").items()) {
    Route route{SegmentsOf(path), {}};
    for (const auto& [key, value] : item.items()) {
      if (key == "parameters") continue;
      std::string method = key;
      for (char& c : method) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      route.methods.push_back(method);
    }
    routes.push_back(std::move(route));
  }
  return routes;
}

bool Matches(const Route& route, const std::vector<std::string>& segments) {
  // Names of map files hold slashes: {file} stands for the rest of the path.
  const bool takes_rest = !route.segments.empty() && route.segments.back() == "{file}";
  const size_t size = route.segments.size();
  if (takes_rest ? segments.size() < size : segments.size() != size) return false;
  return std::equal(route.segments.begin(), route.segments.end(), segments.begin(),
                    [](const std::string& expected, const std::string& segment) {
                      return expected.starts_with('{') ? !segment.empty() : expected == segment;
                    });
}

}  // namespace

const std::string& OpenApiText() {
  static const std::string text = kOpenApiJson;
  return text;
}

std::vector<std::string> MethodsOf(const std::string& path) {
  static const std::vector<Route> routes = ReadRoutes();
  const std::vector<std::string> segments = SegmentsOf(path);
  for (const Route& route : routes)
    if (Matches(route, segments)) return route.methods;
  return {};
}

}  // namespace parkade
