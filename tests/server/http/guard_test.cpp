// What hostile clients were seen to do to the HTTP library, tried on our service.

#include <fstream>

#include "server/store/access/tokens.h"
#include "tests/server/http/raw_client.h"
#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class Guards : public RunningService {
 protected:
  std::string Ask(const std::string& text) {
    client();
    RawClient raw(service_->port());
    raw.Send(text);
    return raw.ReceiveAll();
  }
  void ExpectRefusal(int status, const std::string& text) {
    const std::string answer = Ask(text);
    EXPECT_EQ(StatusOf(answer), status) << text.substr(0, 200) << "\n-> " << answer;
    EXPECT_NE(answer.find("application/problem+json"), std::string::npos) << answer;
    EXPECT_EQ(client().Get("/healthz")->status, 200);
  }
  static std::string Put(const std::string& fields) {
    return "PUT /api/v1/drives?site=lot HTTP/1.1\r\nHost: localhost\r\n" + fields + "\r\n";
  }
  static std::string GetHealth(const std::string& fields) {
    return "GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + fields + "\r\n";
  }
  static std::int64_t ResidentBytes() {
    std::ifstream stream("/proc/self/statm");
    std::int64_t total = 0, resident = 0;
    stream >> total >> resident;
    return resident * ::sysconf(_SC_PAGESIZE);
  }
};

TEST_F(Guards, RefuseBodiesWhoseLengthIsNotSaidBeforehand) {
  ExpectRefusal(411, Put("Transfer-Encoding: chunked\r\n") + "7\r\nlog ok\n\r\n0\r\n\r\n");
  ExpectRefusal(411, Put("Transfer-Encoding: chunked\r\nContent-Length: 7\r\n") + "log ok\n");
  ExpectRefusal(411, Put("") + "log ok\n");
  ExpectRefusal(411, "POST /api/v1/anything HTTP/1.1\r\nHost: localhost\r\n\r\n");
  ExpectRefusal(411, "PATCH /api/v1/drives HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_TRUE(Files().empty());
}

TEST_F(Guards, RefuseALengthThatIsNoNumberOrStandsTwice) {
  for (const char* length : {"7, 7", "-7", "+7", "0x7", "7a", "", "99999999999999999999"})
    ExpectRefusal(400, Put(std::string("Content-Length: ") + length + "\r\n") + "log ok\n");
  ExpectRefusal(400, Put("Content-Length: 7\r\nContent-Length: 8\r\n") + "log ok\n");
  ExpectRefusal(400, Put("Content-Length: 7\r\ncontent-length: 7\r\n") + "log ok\n");
  ExpectRefusal(400,
                "GET /healthz HTTP/1.1\r\nHost: localhost\r\nContent-Length: 7\r\n\r\nlog ok\n");
}

TEST_F(Guards, RefuseEncodedBodies) {
  ExpectRefusal(415, Put("Content-Encoding: gzip\r\nContent-Length: 7\r\n") + "log ok\n");
}

TEST_F(Guards, RefuseLargeBodiesWhereOnlySmallOnesMakeSense) {
  ExpectRefusal(
      413,
      "PUT /api/v1/rigs/car HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999999\r\n\r\n");
  ExpectRefusal(413,
                "POST /api/v1/sites/lot/maps HTTP/1.1\r\nHost: localhost\r\nContent-Length: "
                "99999999999\r\n\r\n");
}

TEST_F(Guards, RefuseControlBytesAsTheyAreAndWrittenOut) {
  ExpectRefusal(400, GetHealth("X-Name: a%0d%0aSet-Cookie: b\r\n"));
  ExpectRefusal(400, GetHealth(std::string("X-Name: a\0b\r\n", 13)));
  ExpectRefusal(400, GetHealth("X-Name: a\x7f\r\n"));
  ExpectRefusal(400, "GET /healthz%00 HTTP/1.1\r\nHost: localhost\r\n\r\n");
  ExpectRefusal(400, "GET /api/v1/drives?site=a%0d%0ab HTTP/1.1\r\nHost: localhost\r\n\r\n");
}

TEST_F(Guards, RefuseHeadsThatCouldBeReadInTwoWays) {
  ExpectRefusal(400, GetHealth("X-Name : a\r\n"));
  ExpectRefusal(400, GetHealth(" folded: a\r\n"));
  ExpectRefusal(400, GetHealth("no colon\r\n"));
  ExpectRefusal(400, "GET /healthz HTTP/1.1\r\n\r\n");
  ExpectRefusal(400, "GET  /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
  for (const char* target :
       {"http://", "http:///healthz", "http://u@localhost/healthz", "https://localhost/healthz"})
    ExpectRefusal(400, std::string("GET ") + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  ExpectRefusal(400, "nonsense\r\n\r\n");
  ExpectRefusal(505, "GET /healthz HTTP/3.0\r\nHost: localhost\r\n\r\n");
}

TEST_F(Guards, RefuseForgedNotesOfTheLibrary) {
  ExpectRefusal(400, GetHealth("REMOTE_ADDR: 6.6.6.6\r\n"));
  ExpectRefusal(400, GetHealth("Local_Port: 1\r\n"));
}

TEST_F(Guards, RefuseSeveralRanges) {
  std::string ranges = "Range: bytes=0-1";
  for (int i = 0; i < 200; ++i) ranges += ",0-";
  ExpectRefusal(416, GetHealth(ranges + "\r\n"));
}

TEST_F(Guards, RefuseChangesAskedForByOtherPages) {
  const std::string fields = "Content-Length: 0\r\n";
  const std::string cancel =
      "POST /api/v1/jobs/0123456789abcdef/cancel HTTP/1.1\r\nHost: 127.0.0.1:8080\r\n" + fields;
  ExpectRefusal(403, cancel + "Origin: https://evil.example\r\n\r\n");
  ExpectRefusal(403, cancel + "Origin: null\r\n\r\n");
  ExpectRefusal(403, cancel + "Sec-Fetch-Site: cross-site\r\n\r\n");
  ExpectRefusal(404, cancel +
                         "Connection: close\r\nSec-Fetch-Site: same-origin\r\nOrigin: "
                         "http://127.0.0.1:8080\r\n\r\n");
}

TEST_F(Guards, RefuseNamesThatOtherPagesPointedHere) {
  // To the browser, a page whose name leads here now is of one origin with the service.
  for (const char* host : {"evil.example", "evil.example:8080", "127.0.0.1.evil.example",
                           "localhost.evil.example:80", "192.168.1.1", "0.0.0.0:8080",
                           "localhost:x", "[::2]:8080", "[::1", "[::1]evil.example", ""}) {
    const std::string fields =
        std::string(" HTTP/1.1\r\nHost: ") + host + "\r\nContent-Length: 0\r\n";
    const std::string origin =
        std::string("Origin: http://") + host + "\r\nSec-Fetch-Site: same-origin\r\n\r\n";
    ExpectRefusal(403, "POST /api/v1/jobs/0123456789abcdef/cancel" + fields + origin);
    ExpectRefusal(403, "GET /api/v1/drives" + fields + "\r\n");
  }
  ExpectRefusal(403, "GET http://evil.example/api/v1/drives HTTP/1.1\r\nHost: localhost\r\n\r\n");
}

TEST_F(Guards, LetEveryNameOfThisMachineIn) {
  for (const char* host :
       {"localhost", "LocalHost:1", "127.0.0.1", "127.9.9.9:65535", "[::1]", "[::1]:8080"}) {
    const std::string fields = std::string("Host: ") + host + "\r\nConnection: close\r\n\r\n";
    EXPECT_EQ(StatusOf(Ask("GET /api/v1/drives HTTP/1.1\r\n" + fields)), 200) << host;
  }
}

TEST_F(Guards, LetAnyNameInWhereThePublicIsLetIn) {
  options_.allow_public = true;
  EXPECT_THROW(client(), Error) << "everybody might do everything";
  Token admin;
  admin.name = "admin";
  admin.role = Role::kAdmin;
  {
    const DataDirectory directory(options_.data);
    Database database(directory.DatabaseFile());
    CreateToken(database, admin);
  }
  EXPECT_EQ(
      StatusOf(Ask("GET /healthz HTTP/1.1\r\nHost: maps.example\r\nConnection: close\r\n\r\n")),
      200);
}

TEST_F(Guards, TakeATargetThatNamesTheHost) {
  const std::string fields = "Host: localhost\r\nConnection: close\r\n";
  const std::string answer =
      Ask("GET http://127.0.0.1:18777/healthz HTTP/1.1\r\n" + fields + "\r\n");
  EXPECT_EQ(StatusOf(answer), 200) << answer;
  EXPECT_EQ(
      StatusOf(Ask("GET HTTP://localhost/api/v1/drives?limit=1 HTTP/1.1\r\n" + fields + "\r\n")),
      200);
}

TEST_F(Guards, BoundTheHead) {
  ExpectRefusal(431, GetHealth("X-Long: " + std::string(40'000, 'a') + "\r\n"));
  std::string many;
  for (int i = 0; i < 5'000; ++i) many += "X-" + std::to_string(i) + ": a\r\n";
  ExpectRefusal(431, GetHealth(many));
}

TEST_F(Guards, CostNoMemoryForAnEndlessHead) {
  client();
  const std::int64_t before = ResidentBytes();
  RawClient raw(service_->port());
  raw.Send("GET / HTTP/1.1\r\nX-Endless: ");
  size_t sent = 0;
  const std::string piece(1 << 20, 'a');
  while (sent < (size_t{64} << 20) && raw.Send(piece)) sent += piece.size();

  EXPECT_LT(ResidentBytes() - before, std::int64_t{16} << 20);
  EXPECT_EQ(client().Get("/healthz")->status, 200);
}

TEST_F(Guards, DoNotTakeABodyForARequest) {
  // A handler that answers without reading the body leaves it in the socket.
  const std::string hidden = "GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const std::string answer =
      Ask("PUT /api/v1/drives?site=../x HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
          std::to_string(hidden.size()) + "\r\n\r\n" + hidden);

  EXPECT_EQ(StatusOf(answer), 400);
  EXPECT_EQ(answer.find("parkade_"), std::string::npos) << answer;
}

TEST_F(Guards, AnswerPipelinedRequestsInOrder) {
  const std::string answer = Ask(
      "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\nGET /readyz HTTP/1.1\r\nHost: localhost\r\n"
      "Connection: close\r\n\r\n");

  const size_t first = answer.find("\"healthy\""), second = answer.find("\"ready\"");
  ASSERT_NE(first, std::string::npos) << answer;
  ASSERT_NE(second, std::string::npos) << answer;
  EXPECT_LT(first, second);
}

TEST_F(Guards, TellAClientThatAsksBeforeItSends) {
  const std::string refused =
      Ask("PUT /api/v1/drives?site=../x HTTP/1.1\r\nHost: localhost\r\nContent-Length: "
          "5000000\r\nExpect: "
          "100-continue\r\n\r\n");
  EXPECT_EQ(StatusOf(refused), 400) << refused;

  RawClient raw(service_->port());
  raw.Send(
      "PUT /api/v1/drives?site=lot HTTP/1.1\r\nHost: localhost\r\nContent-Length: 7\r\nExpect: "
      "100-continue\r\n\r\n");
  EXPECT_EQ(StatusOf(raw.ReceiveUntil("\r\n\r\n")), 100);
  raw.Send("log ok\n");
  EXPECT_NE(raw.ReceiveUntil("\"job\"").find("HTTP/1.1 201"), std::string::npos);
}

TEST_F(Guards, KeepABrokenUploadFromLeavingAnything) {
  client();
  {
    RawClient raw(service_->port());
    raw.Send(
        "PUT /api/v1/drives?site=lot HTTP/1.1\r\nHost: localhost\r\nContent-Length: "
        "50000000\r\n\r\nlog ok\n" +
        std::string(3'000'000, 'x'));
    Eventually([&] { return !Files().empty(); });
  }
  Eventually([&] { return Files().empty(); });
  EXPECT_TRUE(Get("/api/v1/drives").at("items").empty());
}

TEST_F(Guards, TurnRequestsAwayWhenAllThreadsAndTheQueueOfTheirKindAreTaken) {
  options_.num_threads = 4;
  client();
  std::vector<std::unique_ptr<RawClient>> stalled;
  for (int i = 0; i < 4 * 4 + 64 + 8; ++i) {
    stalled.push_back(std::make_unique<RawClient>(service_->port()));
    stalled.back()->Send(Put("Content-Length: 1000000\r\n") + "log ok\n" +
                         std::string(70'000, 'x'));
  }
  const std::string answer = stalled.back()->ReceiveAll();

  EXPECT_EQ(StatusOf(answer), 503) << answer;
  EXPECT_NE(answer.find("Retry-After: 5\r\n"), std::string::npos) << answer;
  EXPECT_EQ(client().Get("/api/v1/drives")->status, 200);
}

TEST_F(Guards, NeverTellAStrangerWhatWentWrongInside) {
  client();
  std::filesystem::remove_all(options_.data / "db");
  std::filesystem::remove_all(options_.data / "tmp");

  const auto answer = Upload("log ok\n");

  ExpectProblem(answer, 500, "internal");
  EXPECT_EQ(answer->body.find(root_.path().string()), std::string::npos) << answer->body;
  EXPECT_FALSE(answer->has_header("EXCEPTION_WHAT"));
}

}  // namespace
}  // namespace parkade
