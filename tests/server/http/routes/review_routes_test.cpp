#include <atomic>

#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class ReviewRoutes : public RunningService {
 protected:
  void SetUp() override { ASSERT_EQ(MapNow("log ok\n").at("state"), "done"); }

  httplib::Result Post(const std::string& path, const std::string& body) {
    return client().Post(path, body, "application/json");
  }
  httplib::Result Do(const Json& step) { return Post(map_ + "/review", step.dump()); }
  Json Comment(const Json& comment) {
    const auto answer = Post(map_ + "/comments", comment.dump());
    EXPECT_EQ(answer->status, 201) << answer->body;
    return Json::parse(answer->body);
  }

  const std::string site_ = "/api/v1/sites/lot";
  const std::string map_ = site_ + "/maps/1";
};

TEST_F(ReviewRoutes, LeadFromDraftToApprovedAndBack) {
  EXPECT_EQ(Get(map_ + "/review").at("state"), "draft");
  EXPECT_EQ(Do({{"action", "submit"}})->status, 200);
  const auto approved =
      Do({{"action", "approve"}, {"comment", "ja: \u00fc"}, {"from", "in_review"}});
  ASSERT_EQ(approved->status, 200) << approved->body;
  const Json review = Json::parse(approved->body);
  EXPECT_EQ(review.at("state"), "approved");
  EXPECT_EQ(review.at("history").at(0).at("comment"), "ja: \u00fc");
  EXPECT_EQ(review.at("history").at(0).at("author"), "local");
  EXPECT_EQ(review.at("counts").at("entries"), 2);
  EXPECT_EQ(Get(site_ + "/maps").at("items").at(0).at("review_state"), "approved");
  EXPECT_EQ(Get(site_).at("approved_version"), 1);

  ExpectProblem(Do({{"action", "approve"}}), 409, "conflict");
  ExpectProblem(Do({{"action", "reject"}, {"comment", "no"}, {"from", "in_review"}}), 409,
                "conflict");
  ExpectProblem(Do({{"action", "reject"}}), 400, "invalid_input");
  EXPECT_EQ(Do({{"action", "reject"}, {"comment", "a pillar"}})->status, 200);
  const Json page = Get(map_ + "/review?limit=1");
  EXPECT_EQ(page.at("history").at(0).at("action"), "reject");
  const Json rest =
      Get(map_ + "/review?limit=2&cursor=" + page.at("next_cursor").get<std::string>());
  EXPECT_EQ(rest.at("history").size(), 2u);
  EXPECT_TRUE(rest.at("next_cursor").is_null());
}

TEST_F(ReviewRoutes, TheManifestStaysAsItIs) {
  const std::string before = client().Get(map_)->body;
  Do({{"action", "submit"}});
  EXPECT_EQ(client().Get(map_)->body, before) << "it is cached for ever";
}

TEST_F(ReviewRoutes, ApprovedLeadsToTheNewestApprovedVersion) {
  const auto none = client().Get(site_ + "/maps/approved/map.glb");
  ExpectProblem(none, 404, "not_found");
  EXPECT_NE(none->body.find("site 'lot' has no approved version"), std::string::npos);
  Do({{"action", "submit"}});
  Do({{"action", "approve"}});
  Post(site_ + "/maps", "");
  Eventually([&] { return Get(site_).at("versions").size() == 2; });

  const auto answer = client().Get(site_ + "/maps/approved/map.glb");
  EXPECT_EQ(answer->status, 307);
  EXPECT_EQ(answer->get_header_value("Location"), map_ + "/map.glb");
  EXPECT_EQ(answer->get_header_value("Cache-Control"), "no-cache");
  EXPECT_EQ(client().Get(site_ + "/maps/approved")->get_header_value("Location"), map_);
}

TEST_F(ReviewRoutes, TakeOnlyWhatTheyKnow) {
  for (const std::string& body :
       {std::string(""), std::string("[]"), std::string("{"), std::string("null"),
        std::string(R"({"action": 7})"), std::string(R"({"action": "bless"})"),
        std::string(R"({"action": "submit", "more": 1})"),
        std::string(R"({"action": "submit", "from": "good"})"),
        std::string("{\"action\": \"comment\", \"comment\": \"\xff\"}"),
        std::string(R"({"action": "comment", "comment": "a\u0000b"})"), std::string(100'000, '['),
        "{\"action\": \"comment\", \"comment\": \"" + std::string(1 << 20, 'x') + "\"}"})
    ExpectProblem(Post(map_ + "/review", body), 400, "invalid_input");
  ExpectProblem(Post(site_ + "/maps/9/review", R"({"action": "submit"})"), 404, "not_found");
  ExpectProblem(client().Put(map_ + "/review", "{}", "application/json"), 405,
                "method_not_allowed");
  EXPECT_EQ(Get(map_ + "/review").at("state"), "draft");
}

TEST_F(ReviewRoutes, AChecklistIsTickedByItemAndKeptByADecision) {
  const Json usual = Get(map_ + "/checklist");
  EXPECT_TRUE(usual.at("usual").get<bool>());
  EXPECT_EQ(usual.at("items").at(0).at("id"), "coverage");
  EXPECT_TRUE(usual.at("items").at(0).at("ticked_by").is_null());

  const auto set = client().Put(
      site_, R"({"review_checklist": [{"id": "ramp", "text": "Ramps"}, {"text": "Bays"}]})",
      "application/json");
  ASSERT_EQ(set->status, 200) << set->body;
  const Json own = Get(site_).at("review_checklist");
  ASSERT_EQ(own.size(), 2u);
  EXPECT_FALSE(own.at(1).at("id").get<std::string>().empty()) << "a new item gets an id";

  const auto ticked =
      client().Put(map_ + "/checklist/ramp", R"({"ticked": true})", "application/json");
  ASSERT_EQ(ticked->status, 200) << ticked->body;
  EXPECT_EQ(Get(map_ + "/checklist").at("items").at(0).at("ticked_by"), "local");
  Do({{"action", "submit"}});
  const Json review = Json::parse(Do({{"action", "approve"}})->body);
  const Json kept = review.at("history").at(0).at("checklist");
  EXPECT_EQ(kept.at(0).at("ticked_by"), "local");
  EXPECT_TRUE(kept.at(1).at("ticked_by").is_null());
  EXPECT_TRUE(review.at("history").at(1).at("checklist").is_null());

  client().Put(site_, R"({"review_checklist": null})", "application/json");
  EXPECT_TRUE(Get(site_).at("review_checklist").is_null());
  EXPECT_TRUE(Get(map_ + "/checklist").at("usual").get<bool>());
}

TEST_F(ReviewRoutes, ChecklistsAreChecked) {
  const auto tick = [&](const std::string& item, const std::string& body) {
    return client().Put(map_ + "/checklist/" + item, body, "application/json");
  };
  ExpectProblem(tick("ramp", R"({"ticked": true})"), 404, "not_found");
  for (const char* body : {"", "{}", R"({"ticked": "yes"})", R"({"ticked": true, "by": "x"})"})
    ExpectProblem(tick("loops", body), 400, "invalid_input");
  ExpectProblem(client().Get(site_ + "/maps/9/checklist"), 404, "not_found");
  for (const char* list :
       {"7", R"(["a"])", R"([{"id": "a"}])", R"([{"text": ""}])", R"([{"text": "a\nb"}])",
        R"([{"id": "a/b", "text": "x"}])", R"([{"id": "a", "text": "x", "more": 1}])",
        R"([{"id": "a", "text": "x"}, {"id": "a", "text": "y"}])"})
    ExpectProblem(client().Put(site_, std::string(R"({"review_checklist": )") + list + "}",
                               "application/json"),
                  400, "invalid_input");
  EXPECT_TRUE(Get(map_ + "/checklist").at("usual").get<bool>());
}

TEST_F(ReviewRoutes, CommentsAreMadeAnsweredChangedAndDeleted) {
  const std::string drive = Get("/api/v1/drives").at("items").at(0).at("id");
  const Json first =
      Comment({{"text", "<b>what</b> is this?"}, {"pin", {{"drive", drive}, {"time", 12.5}}}});
  EXPECT_EQ(first.at("text"), "<b>what</b> is this?");
  EXPECT_EQ(first.at("pin").at("time"), 12.5);
  EXPECT_EQ(first.at("site"), "lot");
  const std::string id = first.at("id");
  const Json answer = Comment({{"text", "a puddle"}, {"thread", id}, {"pin", nullptr}});
  Comment({{"text", "elsewhere"}, {"pin", {{"point", {1, 2.5, -3}}}}});
  EXPECT_EQ(Get(map_ + "/comments").at("items").size(), 3u);
  EXPECT_EQ(Get(map_ + "/comments?thread=" + id).at("items").size(), 2u);
  const Json page = Get(map_ + "/comments?limit=1");
  EXPECT_EQ(page.at("items").at(0).at("text"), "elsewhere");
  EXPECT_TRUE(page.at("next_cursor").is_string());

  const std::string address = map_ + "/comments/" + id;
  const auto changed =
      client().Patch(address, R"({"text": "what?", "resolved": true})", "application/json");
  ASSERT_EQ(changed->status, 200) << changed->body;
  EXPECT_EQ(Get(address).at("text"), "what?");
  EXPECT_EQ(Get(address).at("resolved_by"), "local");
  EXPECT_EQ(Get(map_ + "/review").at("counts").at("resolved_threads"), 1);
  EXPECT_EQ(client().Delete(address)->status, 204);
  EXPECT_TRUE(Get(address).at("deleted").get<bool>());
  EXPECT_EQ(client().Delete(map_ + "/comments/" + answer.at("id").get<std::string>())->status, 204);
  ExpectProblem(client().Get(address), 404, "not_found");
}

TEST_F(ReviewRoutes, CommentsAreChecked) {
  for (const char* body :
       {"{}", R"({"text": ""})", R"({"text": "x", "pin": 7})",
        R"({"text": "x", "pin": {"place": 1}})", R"({"text": "x", "pin": {"point": [1, 2]}})",
        R"({"text": "x", "pin": {"point": [1, 2, 1e999]}})",
        R"({"text": "x", "pin": {"point": [1, 2, "3"]}})",
        R"({"text": "x", "pin": {"drive": "0000000000000000"}})",
        R"({"text": "x", "pin": {"time": 1}})", R"({"text": "x", "thread": 5})",
        R"({"text": "x", "author": "someone else"})"})
    ExpectProblem(Post(map_ + "/comments", body), 400, "invalid_input");
  ExpectProblem(Post(map_ + "/comments", R"({"text": "x", "thread": "../../1"})"), 404,
                "not_found");
  EXPECT_TRUE(Get(map_ + "/comments").at("items").empty());
}

TEST_F(ReviewRoutes, MeasurementsAreSavedAndExported) {
  const std::string address = site_ + "/measurements";
  const auto saved = Post(
      address,
      R"({"kind": "area", "title": "bay", "version": 1, "points": [[0,0,0],[4,0,0],[4,3,0]]})");
  ASSERT_EQ(saved->status, 201) << saved->body;
  const Json measurement = Json::parse(saved->body);
  EXPECT_EQ(measurement.at("value"), 6);
  EXPECT_EQ(Get(saved->get_header_value("Location")), measurement);
  EXPECT_EQ(Get(address).at("items").size(), 1u);
  EXPECT_TRUE(Get(address + "?version=2").at("items").empty());

  const auto geojson = client().Get(address + "?format=geojson");
  EXPECT_EQ(geojson->get_header_value("Content-Type"), "application/geo+json");
  EXPECT_EQ(Json::parse(geojson->body).at("features").size(), 1u);
  const auto csv = client().Get(address + "?format=csv&version=1");
  EXPECT_EQ(csv->get_header_value("Content-Type"), "text/csv; charset=utf-8");
  EXPECT_EQ(std::count(csv->body.begin(), csv->body.end(), '\n'), 4);
  EXPECT_EQ(csv->get_header_value("Content-Disposition"),
            "attachment; filename=\"lot-measurements.csv\"");

  const std::string one = saved->get_header_value("Location");
  EXPECT_EQ(client().Delete(one)->status, 204);
  ExpectProblem(client().Delete(one), 404, "not_found");
}

TEST_F(ReviewRoutes, MeasurementsAreChecked) {
  const std::string address = site_ + "/measurements";
  for (const char* body : {"{}", R"({"kind": "volume", "version": 1, "points": [[0,0,0],[1,1,1]]})",
                           R"({"kind": "height", "version": "1", "points": [[0,0,0],[1,1,1]]})",
                           R"({"kind": "height", "version": 1, "points": "none"})",
                           R"({"kind": "height", "version": 1, "points": [[0,0,0],[1,1]]})",
                           R"({"kind": "height", "version": 1})"})
    ExpectProblem(Post(address, body), 400, "invalid_input");
  ExpectProblem(Post(address, R"({"kind": "height", "version": 9, "points": [[0,0,0],[1,1,1]]})"),
                404, "not_found");
  ExpectProblem(client().Get(address + "?format=xml"), 400, "invalid_input");
  ExpectProblem(client().Get(address + "?version=x"), 400, "invalid_input");
  ExpectProblem(client().Get("/api/v1/sites/none/measurements"), 404, "not_found");
}

TEST_F(ReviewRoutes, ListenersHearOfDecisionsAndComments) {
  std::string heard;
  std::atomic<bool> listens = false;
  std::thread listener([&] {
    DescribedClient other("127.0.0.1", service_->port());
    other.set_read_timeout(20);
    other.Get("/api/v1/events", [&](const char* data, size_t size) {
      heard.append(data, size);
      listens = true;
      return heard.find("\"deleted\":true") == std::string::npos;
    });
  });
  Eventually([&] { return listens.load(); });
  Do({{"action", "submit"}});
  const Json comment = Comment({{"text", "look here"}});
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  client().Delete(map_ + "/comments/" + comment.at("id").get<std::string>());
  listener.join();

  EXPECT_NE(heard.find("event: review"), std::string::npos);
  EXPECT_NE(heard.find("\"review_state\":\"in_review\""), std::string::npos);
  EXPECT_NE(heard.find("event: comment"), std::string::npos);
  EXPECT_NE(heard.find("look here"), std::string::npos);
}

}  // namespace
}  // namespace parkade
