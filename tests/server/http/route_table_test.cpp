#include "server/http/route_table.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "server/http/routes/openapi.h"
#include "tests/server/http/described_answer.h"
#include "tests/support/api_description.h"

namespace parkade {
namespace {

TEST(RouteTable, TellsTheClassOfEveryRequest) {
  struct Case {
    const char *method, *path;
    RouteClass expected;
  };
  for (const Case& c :
       {Case{"GET", "/healthz", RouteClass::kHealth}, Case{"GET", "/metrics", RouteClass::kHealth},
        Case{"PUT", "/api/v1/drives", RouteClass::kUploads},
        Case{"GET", "/api/v1/drives", RouteClass::kApi},
        Case{"GET", "/api/v1/drives/0123", RouteClass::kApi},
        Case{"PATCH", "/api/v1/uploads/0123", RouteClass::kUploads},
        Case{"HEAD", "/api/v1/uploads/0123", RouteClass::kUploads},
        Case{"GET", "/api/v1/uploads/0123", RouteClass::kApi},
        Case{"POST", "/api/v1/uploads", RouteClass::kUploads},
        Case{"PUT", "/api/v1/rigs/car", RouteClass::kUploads},
        Case{"GET", "/api/v1/jobs/0123/log", RouteClass::kDownloads},
        Case{"GET", "/api/v1/sites/lot/maps/1", RouteClass::kApi},
        Case{"GET", "/api/v1/sites/lot/maps/1/a/b.tum", RouteClass::kDownloads},
        Case{"GET", "/api/v1/events", RouteClass::kEvents},
        Case{"GET", "/api", RouteClass::kDownloads}, Case{"GET", "/", RouteClass::kDownloads},
        Case{"GET", "/assets/index.js", RouteClass::kDownloads},
        Case{"GET", "/api/v1/jobs//log", RouteClass::kApi}})
    EXPECT_EQ(RouteOf(c.method, c.path).route_class, c.expected) << c.method << " " << c.path;

  EXPECT_TRUE(RouteOf("PUT", "/api/v1/drives").has_large_body);
  EXPECT_TRUE(RouteOf("PATCH", "/api/v1/uploads/0123").has_large_body);
  EXPECT_TRUE(RouteOf("POST", "/api/v1/uploads").has_large_body);
  EXPECT_FALSE(RouteOf("PATCH", "/api/v1/uploads").has_large_body);
  EXPECT_FALSE(RouteOf("PUT", "/api/v1/rigs/car").has_large_body);
}

TEST(RouteTable, TellsTheMethodsOfAddresses) {
  using Methods = std::set<std::string_view>;
  EXPECT_EQ(MethodsOf("/api/v1/drives"), (Methods{"GET", "PUT"}));
  EXPECT_EQ(MethodsOf("/api/v1/sites/lot/maps/1/tiles/0.glb"), Methods{"GET"});
  EXPECT_EQ(MethodsOf("/api/v1/drives/a/b"), Methods());
  EXPECT_EQ(MethodsOf("/"), Methods());
}

/// "{alias}" is described as a "{version}".
std::string Described(const Route& route) {
  std::string path(route.path);
  if (const size_t at = path.find("{alias}"); at != std::string::npos)
    path.replace(at, 7, "{version}");
  std::string method(route.method);
  for (char& c : method) c = static_cast<char>(std::tolower(c));
  return method + " " + path;
}

TEST(RouteTable, HoldsWhatIsDescribedAndNothingElse) {
  const auto description = nlohmann::json::parse(OpenApiText());
  std::set<std::string> described, in_table;
  for (const auto& [path, item] : description.at("paths").items())
    for (const auto& [method, operation] : item.items())
      if (method != "parameters") described.insert(method + " " + path);
  for (const Route& route : kRoutes)
    if (!route.method.empty()) in_table.insert(Described(route));
  EXPECT_EQ(in_table, described);
}

/// Names in all alternatives of a "security".
std::set<std::string> SchemesIn(const nlohmann::json& security) {
  std::set<std::string> schemes;
  for (const auto& alternative : security)
    for (const auto& scheme : alternative.items()) schemes.insert(scheme.key());
  return schemes;
}

TEST(RouteTable, SaysForWhichCredentialsTheDescriptionAsks) {
  for (const Route& route : kRoutes) {
    if (route.method.empty()) continue;
    const std::string name = Described(route);
    const bool is_change = route.method != "GET" && route.method != "HEAD";
    std::set<std::string> expected;
    if (route.right != Right::kNone || name == "delete /api/v1/session") {
      expected = {"token", "session"};
      if (is_change) expected.insert("csrf");
      if (route.right == Right::kSeeMaps) expected.insert("share");
    }
    const nlohmann::json asked =
        OperationOf(route)->value("security", ApiDescription().at("security"));
    EXPECT_EQ(SchemesIn(asked), expected) << name;
  }
}

TEST(RouteTable, EveryDescribedAnswerHasARequestId) {
  for (const Route& route : kRoutes) {
    if (route.method.empty()) continue;
    for (const auto& [status, response] : OperationOf(route)->at("responses").items())
      EXPECT_TRUE(Resolved(response).at("headers").contains("X-Request-ID"))
          << Described(route) << " " << status;
  }
}

}  // namespace
}  // namespace parkade
