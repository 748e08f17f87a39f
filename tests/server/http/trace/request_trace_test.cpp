// Requests in the log, and their ids in answers.

#include "server/http/trace/request_trace.h"

#include <regex>
#include <sstream>

#include "core/log.h"
#include "tests/server/http/access/guarded_service.h"
#include "tests/server/http/raw_client.h"

namespace parkade {
namespace {

class RequestLog : public GuardedService {
 protected:
  RequestLog() {
    options_.proxy_host = "maps.example.org";
    SetLogLineFormat(LogLineFormat::kJson);
    SetAccessLog(true);
  }
  ~RequestLog() override {
    StopService();
    SetAccessLog(false);
    SetLogLineFormat(LogLineFormat::kText);
  }

  /// Sends a request and returns its line of the log.
  Json LineOf(const std::string& text) {
    client();
    testing::internal::CaptureStderr();
    answer_ = [&] {
      RawClient raw(service_->port());
      raw.Send(text);
      return raw.ReceiveAll();
    }();
    StopService();  // everything is written
    client_.reset();
    log_ = testing::internal::GetCapturedStderr();
    std::smatch field;
    const bool has_id = std::regex_search(answer_, field, std::regex("X-Request-ID: ([^\r]*)"));
    const std::string id = has_id ? field[1].str() : "";
    std::istringstream lines(log_);
    for (std::string line; std::getline(lines, line);) {
      const Json object = Json::parse(line, nullptr, false);
      EXPECT_TRUE(object.is_object()) << line;
      // Those that asked whether the service has started have lines too.
      if (object.is_object() && object.at("message") == "request" && object.at("request") == id)
        return object;
    }
    ADD_FAILURE() << log_;
    return Json::object();
  }

  std::string answer_, log_;
};

TEST_F(RequestLog, SaysWhoAskedForWhatAndHowItWent) {
  const Json line = LineOf(
      "GET /api/v1/drives?limit=secret HTTP/1.1\r\nHost: maps.example.org\r\nConnection: close\r\n"
      "X-Real-IP: 203.0.113.7\r\nX-Request-ID: abc-1\r\nAuthorization: Bearer " +
      tokens_.at("viewer") + "\r\nCookie: hidden\r\n\r\n");

  EXPECT_EQ(line.at("method"), "GET");
  EXPECT_EQ(line.at("path"), "/api/v1/drives");
  EXPECT_EQ(line.at("status"), 400);
  EXPECT_EQ(line.at("class"), "api");
  EXPECT_EQ(line.at("client"), "203.0.113.7");
  EXPECT_EQ(line.at("request"), "abc-1");
  EXPECT_EQ(line.at("bytes_in"), 0);
  EXPECT_EQ(line.at("bytes_out"), answer_.size());
  EXPECT_GE(line.at("ms"), 0.0);
  EXPECT_NE(answer_.find("X-Request-ID: abc-1\r\n"), std::string::npos) << answer_;
  EXPECT_EQ(log_.find("secret"), std::string::npos) << log_;
  EXPECT_EQ(log_.find("hidden"), std::string::npos) << log_;
  EXPECT_EQ(log_.find(tokens_.at("viewer")), std::string::npos) << log_;
}

TEST_F(RequestLog, BelievesNobodyElseWhoHeIs) {
  const Json line = LineOf(
      "GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nX-Real-IP: 203.0.113.7\r\n"
      "X-Request-ID: a b\"{}\r\n\r\n");

  EXPECT_EQ(line.at("client"), "127.0.0.1");
  const std::string id = line.at("request");
  EXPECT_EQ(id.size(), 16u);
  EXPECT_NE(answer_.find("X-Request-ID: " + id + "\r\n"), std::string::npos) << answer_;
}

TEST_F(RequestLog, HoldsRequestsThatWereRefusedBeforeAnyRoute) {
  const Json line = LineOf("GET /healthz HTTP/1.1\r\nHost: elsewhere.example\r\n\r\n");

  EXPECT_EQ(line.at("status"), 403);
  EXPECT_EQ(line.at("path"), "/healthz");
  EXPECT_EQ(line.at("bytes_out"), answer_.size());
  const std::string id = line.at("request");
  EXPECT_NE(answer_.find("X-Request-ID: " + id + "\r\n"), std::string::npos) << answer_;
  EXPECT_EQ(LineOf("nonsense\r\n\r\n").at("request").get<std::string>().size(), 16u);
}

TEST_F(RequestLog, AJobsLinesNameItAndItsAttempt) {
  Become("uploader");
  testing::internal::CaptureStderr();
  const Json job = MapNow("log ok\n");
  StopService();
  const std::string log = testing::internal::GetCapturedStderr();
  std::istringstream lines(log);
  size_t found = 0;
  for (std::string line; std::getline(lines, line);) {
    const Json object = Json::parse(line, nullptr, false);
    const std::string message = object.at("message");
    if (!message.starts_with("job ") && !message.starts_with("published ")) continue;
    EXPECT_EQ(object.at("job"), job.at("id")) << line;
    EXPECT_EQ(object.at("attempt"), 1) << line;
    ++found;
  }
  EXPECT_EQ(found, 3u) << log;
}

TEST(RequestTrace, TakesAddressesAndNothingElseFromAProxy) {
  EXPECT_EQ(ClientAddressFrom("203.0.113.7"), "203.0.113.7");
  EXPECT_EQ(ClientAddressFrom("2001:DB8:0::1"), "2001:db8::1");
  for (const char* text : {"", "203.0.113", "203.0.113.7, 10.0.0.1", "localhost", "::1%lo"})
    EXPECT_EQ(ClientAddressFrom(text), std::nullopt) << text;
  EXPECT_EQ(ClientAddressFrom(std::nullopt), std::nullopt);
}

}  // namespace
}  // namespace parkade
