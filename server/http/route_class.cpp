#include "server/http/route_class.h"

#include <algorithm>

namespace parkade {
namespace {

struct Row {
  std::string_view method;  ///< empty: any
  std::string_view path;    ///< "*" stands for a segment, "**" at the end for one or more
  RouteClass route_class;
  bool has_large_body = false;
};

// The first row that fits counts.
constexpr std::array kRows = {
    Row{"", "/healthz", RouteClass::kHealth},
    Row{"", "/readyz", RouteClass::kHealth},
    Row{"", "/metrics", RouteClass::kHealth},
    Row{"PUT", "/api/v1/drives", RouteClass::kUploads, true},
    Row{"POST", "/api/v1/uploads", RouteClass::kUploads, true},
    Row{"PATCH", "/api/v1/uploads/*", RouteClass::kUploads, true},
    Row{"POST", "/api/v1/uploads/*", RouteClass::kUploads, true},
    Row{"HEAD", "/api/v1/uploads/*", RouteClass::kUploads},    // waits for the part to stop
    Row{"DELETE", "/api/v1/uploads/*", RouteClass::kUploads},  // the same
    Row{"PUT", "/api/v1/rigs/*", RouteClass::kUploads},
    Row{"GET", "/api/v1/rigs/*", RouteClass::kDownloads},
    Row{"GET", "/api/v1/jobs/*/log", RouteClass::kDownloads},
    Row{"GET", "/api/v1/jobs/*/preview.glb", RouteClass::kDownloads},
    Row{"GET", "/api/v1/sites/*/maps/*/**", RouteClass::kDownloads},
    Row{"GET", "/api/v1/sites/*/compare", RouteClass::kDownloads},  // waits for a worker process
    Row{"", "/api/v1/events", RouteClass::kEvents},
    Row{"", "/api/**", RouteClass::kApi},
    Row{"", "/**", RouteClass::kDownloads},  // the viewer
};

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
    if (expected == "/**") return true;
    const std::string_view segment = TakeSegment(path);
    if (expected != segment && (expected != "/*" || segment.size() < 2)) return false;
  }
  return pattern.empty() && path.empty();
}

const Row* FindRow(std::string_view method, std::string_view path) {
  for (const Row& row : kRows)
    if ((row.method.empty() || row.method == method) && Fits(row.path, path)) return &row;
  return nullptr;
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

RouteClass ClassOf(std::string_view method, std::string_view path) {
  const Row* row = FindRow(method, path);
  return row == nullptr ? RouteClass::kApi : row->route_class;
}

bool HasLargeBody(std::string_view method, std::string_view path) {
  const Row* row = FindRow(method, path);
  return row != nullptr && row->has_large_body;
}

}  // namespace parkade
