#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class Maps : public RunningService {
 protected:
  void SetUp() override { ASSERT_EQ(MapNow("log ok\n").at("state"), "done"); }

  httplib::Result GetMesh(const httplib::Headers& headers) { return client().Get(mesh_, headers); }

  const std::string map_ = "/api/v1/sites/lot/maps/1";
  const std::string mesh_ = map_ + "/map.glb";
  const std::string content_ = "glTF of 1 drives";
  const std::string etag_ = '"' + Sha256Of(content_) + '"';
};

TEST_F(Maps, ListTheirFilesWithHashes) {
  const Json map = Get(map_);

  EXPECT_EQ(map.at("site"), "lot");
  EXPECT_EQ(map.at("version"), 1);
  EXPECT_EQ(map.at("drives").at(0).at("name"), "a");
  std::set<std::string> names;
  for (const Json& file : map.at("files")) {
    names.insert(file.at("name"));
    const auto answer = client().Get(file.at("url").get<std::string>());
    ASSERT_EQ(answer->status, 200);
    EXPECT_EQ(answer->body.size(), file.at("bytes"));
    EXPECT_EQ(Sha256Of(answer->body), file.at("sha256"));
    EXPECT_EQ(answer->get_header_value("Content-Type"), file.at("content_type"));
  }
  EXPECT_EQ(names,
            (std::set<std::string>{"a/diagnostics.json", "a/keyframes.json", "a/trajectory.tum",
                                   "empty.txt", "map.glb", "report.json"}));
}

TEST_F(Maps, AreServedAsImmutableWithAStrongTag) {
  const auto answer = GetMesh({});

  EXPECT_EQ(answer->status, 200);
  EXPECT_EQ(answer->body, content_);
  EXPECT_EQ(answer->get_header_value("Content-Type"), "model/gltf-binary");
  EXPECT_EQ(answer->get_header_value("ETag"), etag_);
  EXPECT_EQ(answer->get_header_value("Accept-Ranges"), "bytes");
  EXPECT_NE(answer->get_header_value("Cache-Control").find("immutable"), std::string::npos);
  EXPECT_EQ(answer->get_header_value("X-Content-Type-Options"), "nosniff");
}

TEST_F(Maps, AreNotSentAgainToWhoHasThem) {
  for (const std::string& tag : {etag_, "\"other\", " + etag_, "W/" + etag_, std::string("*")}) {
    const auto answer = GetMesh({{"If-None-Match", tag}});
    EXPECT_EQ(answer->status, 304) << tag;
    EXPECT_TRUE(answer->body.empty());
    EXPECT_EQ(answer->get_header_value("ETag"), etag_);
  }
  EXPECT_EQ(GetMesh({{"If-None-Match", "\"other\""}})->status, 200);
  EXPECT_EQ(
      client().Get(map_, {{"If-None-Match", client().Get(map_)->get_header_value("ETag")}})->status,
      304);
}

TEST_F(Maps, AreServedInParts) {
  const auto part = GetMesh({{"Range", "bytes=5-6"}});
  EXPECT_EQ(part->status, 206);
  EXPECT_EQ(part->body, "of");
  EXPECT_EQ(part->get_header_value("Content-Range"), "bytes 5-6/16");
  EXPECT_EQ(part->get_header_value("Content-Length"), "2");

  EXPECT_EQ(GetMesh({{"Range", "bytes=-6"}})->body, "drives");
  EXPECT_EQ(GetMesh({{"Range", "bytes=10-"}})->body, "drives");
  const auto clamped = GetMesh({{"Range", "bytes=10-99999"}});
  EXPECT_EQ(clamped->body, "drives");
  EXPECT_EQ(clamped->get_header_value("Content-Range"), "bytes 10-15/16");
}

TEST_F(Maps, RefusePartsThatDoNotExist) {
  for (const char* range : {"bytes=16-", "bytes=99-100", "bytes=-0"}) {
    const auto answer = GetMesh({{"Range", range}});
    ExpectProblem(answer, 416, "range_not_satisfiable");
    EXPECT_EQ(answer->get_header_value("Content-Range"), "bytes */16") << range;
  }
  ExpectProblem(GetMesh({{"Range", "bytes=0-1,3-4"}}), 416, "invalid_request");
  EXPECT_EQ(GetMesh({{"Range", "lines=1-2"}})->status, 200);
}

TEST_F(Maps, AreServedInPartsOnlyOfTheVersionTheClientKnows) {
  EXPECT_EQ(GetMesh({{"Range", "bytes=0-3"}, {"If-Range", etag_}})->status, 206);
  EXPECT_EQ(GetMesh({{"Range", "bytes=0-3"}, {"If-Range", "\"other\""}})->status, 200);
  EXPECT_EQ(GetMesh({{"Range", "bytes=0-3"}, {"If-Range", "W/" + etag_}})->status, 200);
  EXPECT_EQ(GetMesh({{"Range", "bytes=0-3"}, {"If-None-Match", etag_}})->status, 304);
}

TEST_F(Maps, AnswerHeadWithoutABody) {
  const auto answer = client().Head(mesh_, {{"Range", "bytes=0-3"}});
  EXPECT_EQ(answer->status, 200);
  EXPECT_EQ(answer->get_header_value("Content-Length"), "16");
  EXPECT_EQ(answer->get_header_value("ETag"), etag_);
}

TEST_F(Maps, MayHoldEmptyFiles) {
  const auto answer = client().Get(map_ + "/empty.txt");
  EXPECT_EQ(answer->status, 200);
  EXPECT_EQ(answer->body, "");
  EXPECT_EQ(answer->get_header_value("Content-Length"), "0");
  ExpectProblem(client().Get(map_ + "/empty.txt", {{"Range", "bytes=0-"}}), 416,
                "range_not_satisfiable");
}

TEST_F(Maps, AreReachedByTheNameLatest) {
  const auto redirect = client().Get("/api/v1/sites/lot/maps/latest/a/trajectory.tum");
  EXPECT_EQ(redirect->status, 307);
  EXPECT_EQ(redirect->get_header_value("Location"), map_ + "/a/trajectory.tum");
  EXPECT_EQ(redirect->get_header_value("Cache-Control"), "no-cache");
  EXPECT_EQ(client().Get("/api/v1/sites/lot/maps/latest")->get_header_value("Location"), map_);
}

TEST_F(Maps, HaveNothingElse) {
  for (const std::string path :
       {"/api/v1/sites/lot/maps/2", "/api/v1/sites/lot/maps/0", "/api/v1/sites/lot/maps/1/none.glb",
        "/api/v1/sites/lot/maps/1/../../../../etc/passwd",
        "/api/v1/sites/lot/maps/1/..%2f..%2fdb%2fmain.db", "/api/v1/sites/none/maps/1/map.glb",
        "/api/v1/sites/none/maps/latest", "/api/v1/sites/none/maps",
        "/api/v1/sites/lot/maps/999999999999/map.glb", "/api/v1/sites/lot/maps/1/a"})
    ExpectProblem(client().Get(path), 404, "not_found");
}

TEST_F(Maps, AreBuiltAgainOnRequestAndTheOldOnesStay) {
  const std::string before = client().Get(map_)->body;
  const auto queued = client().Post("/api/v1/sites/lot/maps", "", "application/json");
  ASSERT_EQ(queued->status, 202) << queued->body;
  EXPECT_EQ(WaitForJob(Json::parse(queued->body).at("id")).at("map_version"), 2);

  EXPECT_EQ(client().Get(map_)->body, before);
  EXPECT_EQ(Get("/api/v1/sites/lot").at("versions"), Json::parse("[1, 2]"));
  EXPECT_EQ(Get("/api/v1/sites/lot").at("bounds").at("max").at(0), 9);
  const Json page = Get("/api/v1/sites/lot/maps?limit=1");
  EXPECT_EQ(page.at("items").at(0).at("version"), 2);
  const std::string cursor = page.at("next_cursor");
  EXPECT_EQ(Get("/api/v1/sites/lot/maps?limit=1&cursor=" + cursor).at("items").at(0).at("version"),
            1);
}

TEST_F(Maps, AreBuiltOnlyFromWhatMakesSense) {
  const auto build = [&](const std::string& body) {
    return client().Post("/api/v1/sites/lot/maps", body, "application/json");
  };
  ExpectProblem(build("[]"), 400, "invalid_input");
  ExpectProblem(build("{\"drives\": \"all\"}"), 400, "invalid_input");
  ExpectProblem(build("{\"cars\": []}"), 400, "invalid_input");
  ExpectProblem(build("{\"drives\": [7]}"), 400, "invalid_input");
  ExpectProblem(build("{\"drives\": [\"0000000000000000\"]}"), 404, "not_found");
  ExpectProblem(client().Post("/api/v1/sites/none/maps", "", "application/json"), 404, "not_found");
  MapNow("log ok again\n", "?filename=b.bag&site=lot");
  ExpectProblem(build(""), 400, "invalid_input");
}

class MergedMaps : public RunningService {
 protected:
  MergedMaps() { options_.merge_drives = true; }
};

TEST_F(MergedMaps, GrowWithEachDriveOfTheSite) {
  MapNow("log ok\n");
  EXPECT_EQ(MapNow("log ok again\n", "?filename=b.bag&site=lot").at("state"), "done");
  MapNow("log ok elsewhere\n", "?filename=c.bag&site=street");

  EXPECT_EQ(client().Get("/api/v1/sites/lot/maps/1/map.glb")->body, "glTF of 1 drives");
  EXPECT_EQ(client().Get("/api/v1/sites/lot/maps/2/map.glb")->body, "glTF of 2 drives");
  EXPECT_EQ(client().Get("/api/v1/sites/street/maps/1/map.glb")->body, "glTF of 1 drives");
}

}  // namespace
}  // namespace parkade
