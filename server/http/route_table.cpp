#include "server/http/route_table.h"

#include <algorithm>

namespace parkade {
namespace {

/// Takes "/NAME" off the front of `path`.
std::string_view TakeSegment(std::string_view& path) {
  const size_t end = std::min(path.find('/', 1), path.size());
  const std::string_view segment = path.substr(0, end);
  path.remove_prefix(end);
  return segment;
}

bool Fits(std::string_view pattern, std::string_view path) {
  while (!pattern.empty() && !path.empty()) {
    const std::string_view expected = TakeSegment(pattern);
    if (expected == "/{any}") return true;
    const std::string_view segment = TakeSegment(path);
    const bool is_parameter = expected.starts_with("/{");
    if (is_parameter ? segment.size() < 2 : segment != expected) return false;
    if (expected == "/{file}") return true;
  }
  return pattern.empty() && path.empty();
}

const Route* FindRoute(std::string_view method, std::string_view path) {
  const auto found = std::find_if(kRoutes.begin(), kRoutes.end(), [&](const Route& route) {
    return (route.method.empty() || route.method == method) && Fits(route.path, path);
  });
  return found == kRoutes.end() ? nullptr : &*found;
}

}  // namespace

const char* NameOf(RouteClass route_class) {
  switch (route_class) {
    case RouteClass::kHealth: return "health";
    case RouteClass::kApi: return "api";
    case RouteClass::kUploads: return "uploads";
    case RouteClass::kDownloads: return "downloads";
    case RouteClass::kEvents: return "events";
  }
  return "";
}

const Route& RouteOf(std::string_view method, std::string_view path) {
  const Route* route = FindRoute(method, path);
  if (method == "HEAD" && route != nullptr && route->method.empty()) route = FindRoute("GET", path);
  return route == nullptr ? kRoutes.back() : *route;
}

std::set<std::string_view> MethodsOf(std::string_view path) {
  std::set<std::string_view> methods;
  for (const Route& route : kRoutes)
    if (!route.method.empty() && Fits(route.path, path)) methods.insert(route.method);
  return methods;
}

}  // namespace parkade
