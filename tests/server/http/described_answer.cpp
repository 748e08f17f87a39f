#include "tests/server/http/described_answer.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/api_description.h"

namespace parkade {
namespace {

using Json = nlohmann::json;

// With what any request may be refused.
const std::set<int> kRefusals = {401, 403, 408, 411, 413, 415, 416, 429, 431, 500, 503, 505, 507};

// Of HTTP itself, caches, browsers and nginx.
const std::set<std::string> kCommonFields = {"Accept-Ranges",
                                             "Allow",
                                             "Cache-Control",
                                             "Connection",
                                             "Content-Disposition",
                                             "Content-Length",
                                             "Content-Security-Policy",
                                             "Content-Type",
                                             "Cross-Origin-Resource-Policy",
                                             "Keep-Alive",
                                             "Referrer-Policy",
                                             "Transfer-Encoding",
                                             "X-Accel-Buffering",
                                             "X-Accel-Redirect",
                                             "X-Content-Type-Options"};

const Json& ResponseFor(const Route& route, int status) {
  static const Json nothing = Json::object();
  const Json& any = ApiDescription().at("components").at("responses").at("Refusal");
  const Json* operation = OperationOf(route);
  if (operation == nullptr) return status >= 400 ? any : nothing;
  const Json& responses = operation->at("responses");
  const std::string key = std::to_string(status);
  if (responses.contains(key)) return Resolved(responses.at(key));
  return kRefusals.contains(status) ? Resolved(responses.at("default")) : nothing;
}

/// A media type without its parameters.
std::string TypeOf(const httplib::Response& response) {
  const std::string type = response.get_header_value("Content-Type");
  return type.substr(0, type.find(';'));
}

void ExpectFields(const Json& described, const httplib::Response& response) {
  EXPECT_TRUE(response.has_header("X-Request-ID"));
  for (const auto& [field, value] : response.headers)
    EXPECT_TRUE(kCommonFields.contains(field) || described.at("headers").contains(field)) << field;
}

void ExpectContent(const Json& described, const httplib::Response& response) {
  const std::string type = TypeOf(response);
  if (!described.contains("content")) {
    EXPECT_EQ(response.body, "");
    return;
  }
  const Json& content = described.at("content");
  const bool is_any = content.contains("*/*");
  ASSERT_TRUE(is_any || content.contains(type)) << "the type '" << type << "'";
  if (is_any || (type != "application/json" && type != "application/problem+json")) return;
  EXPECT_EQ(MismatchWith(content.at(type).at("schema"), Json::parse(response.body)), "");
}

}  // namespace

const Json* OperationOf(const Route& route) {
  std::string path(route.path), method(route.method);
  if (const size_t at = path.find("{alias}"); at != std::string::npos)
    path.replace(at, 7, "{version}");
  for (char& c : method) c = static_cast<char>(std::tolower(c));
  const Json& paths = ApiDescription().at("paths");
  return paths.contains(path) ? &paths.at(path).at(method) : nullptr;
}

void ExpectDescribed(const httplib::Request& request, const httplib::Response& response) {
  const std::string path = request.path.substr(0, request.path.find('?'));
  const Route& route = RouteOf(request.method, path);
  if (route.path == "/{any}") return;  // the viewer's files
  SCOPED_TRACE(request.method + " " + request.path + " answered " +
               std::to_string(response.status) + " " + response.body.substr(0, 2000));
  const Json& described = ResponseFor(route, response.status);
  ASSERT_FALSE(described.empty()) << "the status is not described";
  ExpectFields(described, response);
  const bool has_body = request.method != "HEAD" && !request.content_receiver;
  if (has_body) ExpectContent(described, response);
}

}  // namespace parkade
