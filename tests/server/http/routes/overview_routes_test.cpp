#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

/// Two sites; the second has two versions, of which the first is in review.
class OverviewRoutes : public RunningService {
 protected:
  void SetUp() override {
    MapNow("log ok\n");
    MapNow("log ok b\n", "?filename=b.bag&site=street");
    MapNow("log ok c\n", "?filename=c.bag&site=street");
    Post("/api/v1/sites/street/maps/1/review", {{"action", "submit"}});
  }
  Json Post(const std::string& path, const Json& body) {
    const auto answer = client().Post(path, body.dump(), "application/json");
    EXPECT_LT(answer->status, 300) << answer->body;
    return Json::parse(answer->body);
  }
  std::vector<std::string> NamesOf(const Json& page) {
    std::vector<std::string> names;
    for (const Json& item : page.at("items")) {
      const std::string site = item.contains("site") ? item.at("site") : item.at("name");
      names.push_back(item.contains("version") ? site + "/" + item.at("version").dump() : site);
    }
    return names;
  }
};

TEST_F(OverviewRoutes, VersionsOfAllSitesAreListedByTheirState) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(NamesOf(Get("/api/v1/maps")), (Names{"street/2", "street/1", "lot/1"}));
  EXPECT_EQ(NamesOf(Get("/api/v1/maps?review_state=in_review")), Names{"street/1"});
  EXPECT_EQ(NamesOf(Get("/api/v1/maps?review_state=draft")), (Names{"street/2", "lot/1"}));
  EXPECT_EQ(NamesOf(Get("/api/v1/maps?review_state=draft,in_review")).size(), 3u);
  EXPECT_TRUE(NamesOf(Get("/api/v1/maps?review_state=approved")).empty());
  const Json page = Get("/api/v1/maps?limit=2");
  EXPECT_EQ(
      NamesOf(Get("/api/v1/maps?limit=2&cursor=" + page.at("next_cursor").get<std::string>())),
      Names{"lot/1"});
  ExpectProblem(client().Get("/api/v1/maps?review_state=good"), 400, "invalid_input");
}

TEST_F(OverviewRoutes, SitesSayTheStateOfTheirLatestVersion) {
  using Names = std::vector<std::string>;
  client().Put("/api/v1/sites/empty", "{}", "application/json");
  EXPECT_TRUE(Get("/api/v1/sites/empty").at("review_state").is_null());
  EXPECT_EQ(Get("/api/v1/sites/street").at("review_state"), "draft") << "of version 2";
  Post("/api/v1/sites/street/maps/2/review", {{"action", "submit"}});
  EXPECT_EQ(NamesOf(Get("/api/v1/sites?review_state=in_review")), Names{"street"});
  EXPECT_EQ(NamesOf(Get("/api/v1/sites?review_state=draft")), Names{"lot"});
  ExpectProblem(client().Get("/api/v1/sites?review_state=good"), 400, "invalid_input");
}

TEST_F(OverviewRoutes, OpenThreadsOfAllSitesComeInOneList) {
  const Json first = Post("/api/v1/sites/lot/maps/1/comments", {{"text", "a puddle"}});
  Post("/api/v1/sites/street/maps/1/comments", {{"text", "a gap"}});
  Post("/api/v1/sites/lot/maps/1/comments", {{"text", "mended"}, {"thread", first.at("id")}});

  const Json all = Get("/api/v1/comments?resolved=false");
  ASSERT_EQ(all.at("items").size(), 2u);
  const Json latest = all.at("items").at(0);
  EXPECT_EQ(latest.at("first").at("text"), "a puddle");
  EXPECT_EQ(latest.at("answers"), 1);
  EXPECT_EQ(latest.at("last_author"), "local");
  EXPECT_EQ(latest.at("review_state"), "draft");
  EXPECT_EQ(Get("/api/v1/comments?site=street").at("items").at(0).at("first").at("text"), "a gap");
  EXPECT_EQ(Get("/api/v1/comments?review_state=in_review").at("items").size(), 1u);
  const Json page = Get("/api/v1/comments?limit=1");
  const Json rest =
      Get("/api/v1/comments?limit=1&cursor=" + page.at("next_cursor").get<std::string>());
  EXPECT_EQ(rest.at("items").at(0).at("first").at("text"), "a gap");
  EXPECT_TRUE(rest.at("next_cursor").is_null());

  client().Patch("/api/v1/sites/lot/maps/1/comments/" + first.at("id").get<std::string>(),
                 R"({"resolved": true})", "application/json");
  EXPECT_EQ(Get("/api/v1/comments?resolved=false").at("items").size(), 1u);
  EXPECT_EQ(Get("/api/v1/comments?resolved=true").at("items").size(), 1u);
  ExpectProblem(client().Get("/api/v1/comments?resolved=maybe"), 400, "invalid_input");
  ExpectProblem(client().Get("/api/v1/comments?review_state=good"), 400, "invalid_input");
}

}  // namespace
}  // namespace parkade
