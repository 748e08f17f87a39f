#include "server/store/care/retention.h"
#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class SiteRoutes : public RunningService {
 protected:
  httplib::Result Put(const std::string& body, const std::string& site = "lot") {
    return client().Put("/api/v1/sites/" + site, body, "application/json");
  }
  void PutRig(const std::string& name) {
    httplib::MultipartFormDataItems form;
    for (const char* file : {"camchain-imucam.yaml", "imu0.yaml", "vehicle.yaml"})
      form.push_back({file, "rostopic: /x\n", file, "application/yaml"});
    EXPECT_EQ(client().Put("/api/v1/rigs/" + name, httplib::Headers(), form)->status, 201);
  }
};

TEST_F(SiteRoutes, SettingsAreKeptAndShown) {
  PutRig("car");
  const auto made = Put(R"({"title": "Level 2", "note": "two\nlines", "default_rig": "car",
                            "retention": {"log_days": 90, "map_days": null}})");
  ASSERT_EQ(made->status, 201) << made->body;
  const Json site = Get("/api/v1/sites/lot");
  EXPECT_EQ(site.at("title"), "Level 2");
  EXPECT_EQ(site.at("retention"), Json::parse(R"({"log_days": 90, "map_days": null})"));
  EXPECT_EQ(site.at("default_rig"), "car");
  EXPECT_EQ(Json::parse(made->body), site);

  EXPECT_EQ(Put(R"({"retention": {"log_days": null}, "default_rig": null})")->status, 200);
  EXPECT_TRUE(Get("/api/v1/sites/lot").at("retention").at("log_days").is_null());
  EXPECT_TRUE(Get("/api/v1/sites/lot").at("default_rig").is_null());
  EXPECT_EQ(Get("/api/v1/sites/lot").at("title"), "Level 2") << "what is not named stays";
}

TEST_F(SiteRoutes, SettingsAreChecked) {
  for (const char* body :
       {"[]", R"({"name": "x"})", R"({"title": 7})", R"({"title": "two\nlines"})",
        R"({"retention": 90})", R"({"retention": {"days": 1}})",
        R"({"retention": {"log_days": 0}})", R"({"retention": {"log_days": 1.5}})",
        R"({"retention": {"log_days": 99999999999999999999}})", R"({"default_rig": "truck"})"})
    ExpectProblem(Put(body), 400, "invalid_input");
  ExpectProblem(client().Get("/api/v1/sites/lot"), 404, "not_found");
  ExpectProblem(Put("{}", "..%2fx"), 404, "not_found");
}

TEST_F(SiteRoutes, UploadsThatNameNoRigUseTheDefault) {
  PutRig("car");
  PutRig("truck");
  Put(R"({"default_rig": "car"})");
  const auto rig_of = [](const httplib::Result& answer) {
    return Json::parse(answer->body).at("drive").at("rig");
  };
  EXPECT_EQ(rig_of(Upload("log ok\n")), "car");
  EXPECT_EQ(rig_of(Upload("log ok b\n", "?filename=b.bag&site=lot&rig=truck")), "truck");
  EXPECT_TRUE(rig_of(Upload("log ok c\n", "?filename=c.bag&site=street")).is_null());

  // tus; site is "lot" in base64.
  const std::string log = "log ok d\n";
  const auto made = client().Post("/api/v1/uploads",
                                  {{"Tus-Resumable", "1.0.0"},
                                   {"Upload-Length", std::to_string(log.size())},
                                   {"Upload-Metadata", "site bG90"}},
                                  log, "application/offset+octet-stream");
  ASSERT_EQ(made->status, 201) << made->body;
  EXPECT_EQ(Get("/api/v1/drives/" + made->get_header_value("Upload-Drive")).at("rig"), "car");
}

TEST_F(SiteRoutes, WhatTheRetentionDeletedIsSaid) {
  MapNow("log ok\n");
  client().Post("/api/v1/sites/lot/maps", "", "application/json");
  Eventually([&] { return Get("/api/v1/sites/lot").at("versions").size() == 2; });
  Put(R"({"retention": {"log_days": 1, "map_days": 1}})");
  StopService();
  {
    Store store(options_.data);
    DeleteExpired(store, std::chrono::system_clock::now() + std::chrono::days(2));
  }
  client_.reset();

  const Json drive = Get("/api/v1/drives").at("items").at(0);
  EXPECT_EQ(drive.at("log"), "deleted");
  EXPECT_EQ(drive.at("state"), "ready");
  const std::string map = "/api/v1/sites/lot/maps/1";
  for (const std::string& path : {map, map + "/map.glb"})
    ExpectProblem(client().Get(path), 410, "deleted");
  ExpectProblem(client().Get("/api/v1/sites/lot/compare?from=1&to=2"), 409, "conflict");
  EXPECT_EQ(client().Get("/api/v1/sites/lot/maps/2/map.glb")->status, 200);
  EXPECT_TRUE(Get("/api/v1/sites/lot/maps").at("items").at(1).at("files_deleted_at").is_string());
  const auto build = client().Post("/api/v1/sites/lot/maps",
                                   Json{{"drives", {drive.at("id")}}}.dump(), "application/json");
  ExpectProblem(build, 409, "conflict");
  EXPECT_NE(build->body.find("the log of drive 'a' was deleted on "), std::string::npos);
}

}  // namespace
}  // namespace parkade
