#include "server/store/access/audit_log.h"
#include "tests/server/http/access/guarded_service.h"

namespace parkade {
namespace {

using Access = GuardedService;

TEST_F(Access, BeginsWithTheFirstTokenWhileTheServiceRuns) {
  options_.data = root_.path() / "open";
  EXPECT_EQ(Ask("GET", "/api/v1/drives", httplib::Headers())->status, 200);
  {
    Database beside(options_.data / "db" / "main.db", DatabaseUse::kShare);
    EXPECT_THROW(Made(beside, "first", Role::kViewer), Error) << "nobody could make another";
    tokens_["first"] = Made(beside, "first", Role::kAdmin).secret;
  }
  const auto refused = Ask("GET", "/api/v1/drives", httplib::Headers());
  ExpectProblem(refused, 401, "unauthenticated");
  EXPECT_EQ(refused->get_header_value("WWW-Authenticate"), "Bearer");
  EXPECT_EQ(Ask("GET", "/api/v1/drives", "first")->status, 200);
}

TEST_F(Access, TokensAreShownOnceAndWorkUntilRevoked) {
  const auto made = Ask("POST", "/api/v1/tokens", "admin",
                        R"({"name": "car 7", "role": "uploader", "sites": ["lot"], "days": 1})");
  ASSERT_EQ(made->status, 201) << made->body;
  const Json token = Json::parse(made->body);
  tokens_["car"] = token.at("token");
  EXPECT_EQ(Ask("GET", "/api/v1/jobs", "car")->status, 200);
  const std::string list = Ask("GET", "/api/v1/tokens", "admin")->body;
  EXPECT_NE(list.find("car 7"), std::string::npos);
  for (const auto& [name, secret] : tokens_)
    EXPECT_EQ(list.find(secret.substr(14)), std::string::npos) << name;

  EXPECT_EQ(Ask("DELETE", made->get_header_value("Location"), "admin")->status, 204);
  EXPECT_EQ(Ask("GET", "/api/v1/jobs", "car")->status, 401);
  ExpectProblem(Ask("DELETE", made->get_header_value("Location"), "admin"), 409, "conflict");
}

TEST_F(Access, UnusableTokensAreRefusedWithASentence) {
  for (const char* body :
       {R"({"role": "viewer"})", R"({"name": "", "role": "viewer"})",
        R"({"name": "a\u0007", "role": "viewer"})", R"({"name": "a", "role": "king"})",
        R"({"name": "a", "role": "viewer", "sites": ["../x"]})",
        R"({"name": "a", "role": "viewer", "sites": []})",
        R"({"name": "a", "role": "viewer", "days": 0})",
        R"({"name": "a", "role": "viewer", "days": "1"})", R"({"name": 1, "role": "viewer"})",
        R"({"name": "a", "role": "viewer", "rights": "all"})", "[]", "x"})
    ExpectProblem(Ask("POST", "/api/v1/tokens", "admin", body), 400, "invalid_input");
}

TEST_F(Access, ALinkLeadsToItsVersionAlone) {
  Become("admin");
  MapNow("log ok\n");
  MapNow("log ok again\n", "?filename=b.bag&site=lot");
  const auto made = Ask("POST", "/api/v1/shares", "admin",
                        R"({"name": "the city", "site": "lot", "version": 1})");
  ASSERT_EQ(made->status, 201) << made->body;
  tokens_["link"] = Json::parse(made->body).at("token");

  const std::string maps = "/api/v1/sites/lot/maps";
  EXPECT_EQ(Ask("GET", maps + "/1/map.glb", "link")->status, 200);
  ExpectProblem(Ask("GET", maps + "/2/map.glb", "link"), 404, "not_found");
  EXPECT_EQ(Json::parse(Ask("GET", maps, "link")->body).at("items").size(), 1u);
  EXPECT_EQ(Json::parse(Ask("GET", "/api/v1/sites/lot", "link")->body).at("versions"),
            Json::parse("[1]"));
  EXPECT_EQ(Ask("GET", maps + "/latest", "link")->get_header_value("Location"), maps + "/1");
  ExpectProblem(Ask("GET", "/api/v1/sites/lot/compare?from=1&to=2", "link"), 404, "not_found");
  ExpectProblem(Ask("GET", "/api/v1/drives", "link"), 403, "forbidden");

  EXPECT_EQ(Ask("DELETE", made->get_header_value("Location"), "reviewer")->status, 204);
  EXPECT_EQ(Ask("GET", maps + "/1/map.glb", "link")->status, 401);
}

TEST_F(Access, UploadersChangeWhatTheyBroughtInAlone) {
  Become("uploader");
  const Json job = MapNow("log ok\n");
  const std::string drive = "/api/v1/drives/" + job.at("drives").at(0).get<std::string>();
  ExpectProblem(Ask("DELETE", drive, "second uploader"), 403, "forbidden");
  ExpectProblem(Ask("DELETE", drive, "reviewer"), 403, "forbidden");
  EXPECT_EQ(Ask("DELETE", drive, "uploader")->status, 204);
}

TEST_F(Access, EachCallerMayAskSoOften) {
  options_.request_rate = 1;
  int refused = 0;
  for (int i = 0; i < 30; ++i)
    if (Ask("GET", "/api/v1/drives", "viewer")->status == 429) ++refused;
  EXPECT_GE(refused, 1);
  EXPECT_EQ(Ask("GET", "/api/v1/drives", "reviewer")->status, 200);
  EXPECT_EQ(Ask("GET", "/healthz", httplib::Headers())->status, 200);
}

TEST_F(Access, WhoAsksBeforeSendingIsAnsweredBeforeSending) {
  const auto answer =
      Ask("PUT", "/api/v1/drives?filename=a.bag&site=lot",
          {{"Authorization", "Bearer " + tokens_.at("viewer")}, {"Expect", "100-continue"}},
          "log ok\n");
  ExpectProblem(answer, 403, "forbidden");
}

TEST_F(Access, EveryChangeIsOneEntryOfTheAuditLog) {
  Become("uploader");
  const Json job = MapNow("log ok\n");
  const std::string drive = job.at("drives").at(0);
  Ask("DELETE", "/api/v1/drives/" + drive, "second uploader");  // refused: no entry
  Ask("POST", "/api/v1/sites/lot/maps", "reviewer");
  Ask("DELETE", "/api/v1/drives/0000000000000000", "uploader");  // nothing was changed

  const Json log = Json::parse(Ask("GET", "/api/v1/audit?limit=200", "admin")->body).at("items");
  std::map<std::string, int> of_action;
  for (const Json& entry : log) ++of_action[entry.at("action")];
  EXPECT_EQ(of_action["drive.create"], 1);
  EXPECT_EQ(of_action["drive.delete"], 0);
  EXPECT_EQ(of_action["job.create"], 1);
  EXPECT_GE(of_action["map.publish"], 1);
  EXPECT_EQ(of_action["token.create"], 11);
  EXPECT_EQ(of_action["token.revoke"], 1);
  for (const Json& entry : log) {
    if (entry.at("action") != "drive.create") continue;
    EXPECT_EQ(entry.at("subject"), drive);
    EXPECT_EQ(entry.at("caller").at("name"), "uploader");
    EXPECT_EQ(entry.at("address"), "127.0.0.1");
    EXPECT_EQ(entry.at("detail").at("site"), "lot");
  }
}

}  // namespace
}  // namespace parkade
