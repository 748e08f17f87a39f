#include "tests/server/http/access/guarded_service.h"

namespace parkade {
namespace {

class Sessions : public GuardedService {
 protected:
  struct Session {
    std::string cookie, csrf;
  };

  httplib::Result SignIn(const std::string& secret, httplib::Headers headers = {}) {
    return Ask("POST", "/api/v1/session", std::move(headers), Json{{"token", secret}}.dump());
  }
  Session Begin(const std::string& name) {
    const auto answer = SignIn(tokens_.at(name));
    EXPECT_EQ(answer->status, 201) << answer->body;
    const std::string cookie = answer->get_header_value("Set-Cookie");
    return {cookie.substr(0, cookie.find(';')), Json::parse(answer->body).at("csrf")};
  }
};

TEST_F(Sessions, CarryWhatTheirTokenMay) {
  const Session session = Begin("uploader");
  const auto shown = Ask("GET", "/api/v1/session", {{"Cookie", session.cookie}});
  const Json json = Json::parse(shown->body);
  EXPECT_EQ(json.at("access"), "token");
  EXPECT_EQ(json.at("caller").at("name"), "uploader");
  EXPECT_EQ(json.at("caller").at("role"), "uploader");
  EXPECT_EQ(json.at("csrf"), session.csrf);

  EXPECT_EQ(Ask("GET", "/api/v1/drives", {{"Cookie", session.cookie}})->status, 200);
  EXPECT_EQ(Ask("GET", "/api/v1/tokens", {{"Cookie", session.cookie}})->status, 403);
  EXPECT_EQ(Ask("GET", "/api/v1/drives", {{"Cookie", "other=1; " + session.cookie}})->status, 200);
}

TEST_F(Sessions, ChangeNothingWithoutTheTokenOfTheirPage) {
  const Session session = Begin("uploader");
  const std::string path = "/api/v1/drives?filename=a.bag&site=lot";
  ExpectProblem(Ask("PUT", path, {{"Cookie", session.cookie}}, "log ok\n"), 403, "csrf");
  const httplib::Headers wrong = {{"Cookie", session.cookie},
                                  {"X-CSRF-Token", std::string(64, '0')}};
  ExpectProblem(Ask("PUT", path, wrong, "log ok\n"), 403, "csrf");
  const httplib::Headers right = {{"Cookie", session.cookie}, {"X-CSRF-Token", session.csrf}};
  EXPECT_EQ(Ask("PUT", path, right, "log ok\n")->status, 201);
}

TEST_F(Sessions, HideTheirCookieFromScriptsAndOtherSites) {
  const std::string cookie = SignIn(tokens_.at("viewer"))->get_header_value("Set-Cookie");
  for (const char* attribute : {"; HttpOnly", "; SameSite=Strict", "; Path=/"})
    EXPECT_NE(cookie.find(attribute), std::string::npos) << cookie;
  EXPECT_EQ(cookie.find("Secure"), std::string::npos) << "a browser would drop it without TLS";
  const std::string behind_tls = SignIn(tokens_.at("viewer"), {{"X-Forwarded-Proto", "https"}})
                                     ->get_header_value("Set-Cookie");
  EXPECT_TRUE(behind_tls.starts_with("__Host-parkade=")) << behind_tls;
  EXPECT_NE(behind_tls.find("; Secure"), std::string::npos) << behind_tls;
}

TEST_F(Sessions, EndByWishAndWithTheirToken) {
  const Session session = Begin("viewer"), other = Begin("uploader");
  const httplib::Headers mine = {{"Cookie", session.cookie}, {"X-CSRF-Token", session.csrf}};
  EXPECT_EQ(Ask("DELETE", "/api/v1/session", mine)->status, 204);
  EXPECT_EQ(Ask("GET", "/api/v1/drives", mine)->status, 401);

  const Json tokens = Json::parse(Ask("GET", "/api/v1/tokens", "admin")->body).at("items");
  for (const Json& token : tokens) {
    if (token.at("name") != "uploader") continue;
    const std::string address = "/api/v1/tokens/" + token.at("id").get<std::string>();
    EXPECT_EQ(Ask("DELETE", address, "admin")->status, 204);
  }
  EXPECT_EQ(Ask("GET", "/api/v1/drives", {{"Cookie", other.cookie}})->status, 401);
  const Json nobody = Json::parse(Ask("GET", "/api/v1/session", {{"Cookie", other.cookie}})->body);
  EXPECT_EQ(nobody.at("caller"), nullptr);
  EXPECT_EQ(nobody.at("csrf"), nullptr);
}

TEST_F(Sessions, AreNotBegunByAnotherSitesPage) {
  ExpectProblem(SignIn(tokens_.at("viewer"), {{"Origin", "https://evil.example"}}), 403,
                "foreign_origin");
}

TEST_F(Sessions, AreRefusedAfterTenFailuresAMinute) {
  for (int i = 0; i < 10; ++i) EXPECT_EQ(SignIn("parkade_token_wrong")->status, 401);
  const auto answer = SignIn("parkade_token_wrong");
  ExpectProblem(answer, 429, "too_many_requests");
  EXPECT_GE(std::stoi(answer->get_header_value("Retry-After")), 1);
  // Who is known gets in all the same: others at this address must not be able to lock it out.
  EXPECT_EQ(Ask("GET", "/api/v1/drives", "viewer")->status, 200);
}

TEST_F(Sessions, AreNotNeededWhileNobodyNeedsAToken) {
  options_.data = root_.path() / "open";
  const Json json = Json::parse(Ask("GET", "/api/v1/session", httplib::Headers())->body);
  EXPECT_EQ(json.at("access"), "open");
  EXPECT_EQ(json.at("caller").at("role"), "admin");
  ExpectProblem(SignIn("x"), 409, "conflict");
  ExpectProblem(
      Ask("POST", "/api/v1/tokens", httplib::Headers(), R"({"name": "me", "role": "admin"})"), 409,
      "conflict");
}

}  // namespace
}  // namespace parkade
