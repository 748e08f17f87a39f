#include <regex>

#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

using Status = RunningService;

TEST_F(Status, IsHealthyAndReady) {
  EXPECT_EQ(Get("/healthz").at("healthy"), true);
  const Json ready = Get("/readyz");
  EXPECT_EQ(ready.at("ready"), true);
  EXPECT_EQ(ready.at("database"), true);
}

TEST_F(Status, HasMetricsThatPrometheusReads) {
  MapNow("log ok\n");
  const auto answer = client().Get("/metrics");

  EXPECT_EQ(answer->get_header_value("Content-Type"), "text/plain; version=0.0.4; charset=utf-8");
  const std::regex line(
      R"x(# (HELP|TYPE) [a-z_]+ .+|[a-z_]+(\{[a-z]+="[0-9a-z]+"(,le="(\+Inf|[0-9.]+)")?\})? [0-9.e-]+)x");
  std::istringstream lines(answer->body);
  for (std::string text; std::getline(lines, text);)
    EXPECT_TRUE(std::regex_match(text, line)) << text;
  EXPECT_NE(answer->body.find("parkade_jobs{state=\"done\"} 1\n"), std::string::npos)
      << answer->body;
  EXPECT_NE(answer->body.find("parkade_upload_bytes_total 7\n"), std::string::npos);
  EXPECT_NE(answer->body.find("parkade_http_threads_busy{class=\"health\"} 1\n"), std::string::npos)
      << answer->body;
}

TEST_F(Status, CountsHowLongAnswersTake) {
  EXPECT_EQ(Upload("log ok\n")->status, 201);
  const std::string name = "parkade_http_request_seconds";
  std::string text;
  Eventually([&] {
    text = client().Get("/metrics")->body;
    return text.find(name + "_count{class=\"uploads\"} 1\n") != std::string::npos;
  });
  EXPECT_NE(text.find(name + "_bucket{class=\"uploads\",le=\"300\"} 1\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find(name + "_bucket{class=\"uploads\",le=\"+Inf\"} 1\n"), std::string::npos);
  EXPECT_NE(text.find(name + "_count{class=\"events\"} 0\n"), std::string::npos);
  const size_t sum = text.find(name + "_sum{class=\"uploads\"} ");
  ASSERT_NE(sum, std::string::npos);
  EXPECT_GT(std::stod(text.substr(text.find(' ', sum))), 0);
}

TEST_F(Status, TellsAWrongMethodFromAWrongAddress) {
  ExpectProblem(client().Get("/api/v1/nothing"), 404, "not_found");
  const auto wrong = client().Post("/api/v1/drives", "x", "text/plain");
  ExpectProblem(wrong, 405, "method_not_allowed");
  EXPECT_EQ(wrong->get_header_value("Allow"), "GET, PUT");
  ExpectProblem(client().Delete("/api/v1/sites/lot/maps/1/map.glb"), 405, "method_not_allowed");
  ExpectProblem(client().Options("/api/v1/drives"), 405, "method_not_allowed");
}

const std::string kNothing = "0000000000000000";

/// An address of a described path, of things that exist where there are some.
std::string Filled(std::string path, const std::string& drive, const std::string& job) {
  const auto fill = [&](const std::string& name, const std::string& value) {
    if (const size_t at = path.find(name); at != std::string::npos)
      path.replace(at, name.size(), value);
  };
  fill("{drive}", drive);
  fill("{job}", job);
  fill("{camera}", "cam0");
  fill("{site}", "lot");
  fill("{rig}", "car");
  fill("{version}", "1");
  fill("{file}", "a/trajectory.tum");
  // Of other things there are none.
  for (size_t begin = 0; (begin = path.find('{')) != std::string::npos;)
    path.replace(begin, path.find('}') - begin + 1, kNothing);
  return path;
}

// That each answer is as described, its client checks.
TEST_F(Status, DescribesOnlyWhatAnswers) {
  const Json job = MapNow("log ok\n");
  const std::string drive = job.at("drives").at(0);
  const std::string to_delete =
      MapNow("log ok\n", "?filename=to-delete&site=other").at("drives").at(0);
  const auto new_upload = [&] {
    const auto answer =
        client().Post("/api/v1/uploads",
                      httplib::Headers{{"Tus-Resumable", "1.0.0"}, {"Upload-Length", "9"}}, "", "");
    return answer->get_header_value("Location");
  };
  const std::string upload = new_upload(), upload_to_delete = new_upload();
  const Json description = Get("/api/v1/openapi.json");
  EXPECT_EQ(description.at("openapi"), "3.1.0");

  int operations = 0;
  for (const auto& [path, item] : description.at("paths").items()) {
    for (const auto& [method, operation] : item.items()) {
      std::string address = Filled(path, method == "delete" ? to_delete : drive, job.at("id"));
      if (path == "/api/v1/uploads/{upload}")
        address = method == "delete" ? upload_to_delete : upload;
      if (method == "parameters" || path == "/api/v1/events") continue;
      ++operations;
      httplib::Request request;
      request.path = address;
      request.method = method;
      for (char& c : request.method) c = static_cast<char>(std::toupper(c));
      request.set_header("Tus-Resumable", "1.0.0");
      request.set_header("X-HTTP-Method-Override", "PATCH");
      const auto answer = client().send(request);
      ASSERT_TRUE(answer) << method << " " << address;
      // Found, and its body or state found wanting at most.
      const bool is_missing_rig =
          path == "/api/v1/rigs/{rig}" && method == "get" && answer->status == 404;
      const bool has_no_preview = path.ends_with("/preview.glb") && answer->status == 404;
      const bool is_missing = address.find(kNothing) != std::string::npos && answer->status == 404;
      EXPECT_TRUE(is_missing || is_missing_rig || has_no_preview || answer->status < 300 ||
                  answer->status == 400 || answer->status == 409)
          << method << " " << address << ": " << answer->status << " " << answer->body;
    }
  }
  EXPECT_GE(operations, 20);
}

}  // namespace
}  // namespace parkade
