#include "server/http/access/router.h"

#include <array>
#include <string>
#include <string_view>

#include "core/error.h"

namespace parkade {
namespace {

// Patterns of parameters. They are bounded, since they run on whatever path a stranger sends.
constexpr std::string_view kId = "([0-9a-f]{16})";
constexpr std::string_view kName = "([A-Za-z0-9][A-Za-z0-9._-]{0,63})";

struct Parameter {
  std::string_view name, pattern;
};

// All others are ids.
constexpr std::array kParameters = {
    Parameter{"{site}", kName},
    Parameter{"{rig}", kName},
    Parameter{"{camera}", kName},
    Parameter{"{item}", kName},
    Parameter{"{version}", "([0-9]{1,9})"},
    Parameter{"{alias}", "(latest|approved)"},
    Parameter{"{file}", "([A-Za-z0-9][A-Za-z0-9._/-]{0,255})"},
};

std::string_view PatternOf(std::string_view name) {
  for (const Parameter& parameter : kParameters)
    if (parameter.name == name) return parameter.pattern;
  return kId;
}

/// The path as a regular expression.
std::string PatternOfPath(std::string_view path) {
  std::string pattern;
  while (!path.empty()) {
    const size_t begin = std::min(path.find('{'), path.size());
    for (const char c : path.substr(0, begin)) pattern += c == '.' ? "\\." : std::string(1, c);
    path.remove_prefix(begin);
    if (path.empty()) break;
    const size_t size = path.find('}') + 1;
    pattern += PatternOf(path.substr(0, size));
    path.remove_prefix(size);
  }
  return pattern;
}

}  // namespace

void Router::Add(const Route& route, AnyHandler handler) {
  const std::string pattern = PatternOfPath(route.path);
  const auto answer = [&gate = gate_, &route, handler = std::move(handler)](
                          const httplib::Request& request, httplib::Response& response,
                          const httplib::ContentReader* body) {
    const Caller caller = gate.Admit(route, request, response);
    const WorkFor scope(caller);
    handler(request, response, body);
  };
  const auto without_body = [answer](const httplib::Request& request, httplib::Response& response) {
    answer(request, response, nullptr);
  };
  // The library would read a body before it calls a handler that does not ask for its reader.
  const auto with_body = [answer](const httplib::Request& request, httplib::Response& response,
                                  const httplib::ContentReader& body) {
    answer(request, response, &body);
  };
  if (route.method == "GET")
    http_.Get(pattern, without_body);
  else if (route.method == "OPTIONS")
    http_.Options(pattern, without_body);
  else if (route.method == "PUT")
    http_.Put(pattern, with_body);
  else if (route.method == "POST")
    http_.Post(pattern, with_body);
  else if (route.method == "PATCH")
    http_.Patch(pattern, with_body);
  else if (route.method == "DELETE")
    http_.Delete(pattern, with_body);
  else
    throw Error(ErrorCode::kInternal, "no handler is added for " + std::string(route.method));
}

}  // namespace parkade
