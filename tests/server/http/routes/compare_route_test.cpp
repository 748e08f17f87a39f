#include <atomic>
#include <memory>

#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class Comparisons : public RunningService {
 protected:
  Comparisons() {
    options_.compare_command = [command = options_.compare_command, this](
                                   const auto& from, const auto& to, const auto& out) {
      ++num_made_;
      return command(from, to, out);
    };
  }
  void SetUp() override {
    ASSERT_EQ(MapNow("log ok\n").at("state"), "done");
    ASSERT_EQ(MapNow("log ok again\n", "?filename=b.bag&site=lot").at("state"), "done");
  }
  httplib::Result Compare(const std::string& query) {
    return client().Get("/api/v1/sites/lot/compare" + query);
  }

  std::atomic<int> num_made_ = 0;  ///< comparisons that a process was started for
};

TEST_F(Comparisons, SayWhatTheyCompare) {
  const Json json = Get("/api/v1/sites/lot/compare?from=1&to=2");
  EXPECT_EQ(json.at("site"), "lot");
  EXPECT_EQ(json.at("from"), 1);
  EXPECT_EQ(json.at("to"), 2);
  EXPECT_EQ(json.at("free_space").at("gained"), 0);
  const auto outlines = client().Get(json.at("urls").at("geojson").get<std::string>());
  EXPECT_EQ(outlines->status, 200);
  EXPECT_EQ(outlines->get_header_value("Content-Type"), "application/geo+json");
  EXPECT_EQ(
      client().Get(json.at("urls").at("png").get<std::string>())->get_header_value("Content-Type"),
      "image/png");
}

TEST_F(Comparisons, AreMadeOnceAndMayBeKeptForEver) {
  const auto answer = Compare("?from=1&to=2");
  EXPECT_NE(answer->get_header_value("Cache-Control").find("immutable"), std::string::npos);
  const std::string etag = answer->get_header_value("ETag");
  EXPECT_EQ(
      client().Get("/api/v1/sites/lot/compare?from=1&to=2", {{"If-None-Match", etag}})->status,
      304);
  Compare("?from=1&to=2&format=png");
  EXPECT_EQ(num_made_, 1);
  Compare("?from=2&to=1");
  EXPECT_EQ(num_made_, 2);
}

TEST_F(Comparisons, WithTheLatestVersionLeadToItsNumber) {
  const auto redirect = Compare("?from=1&format=geojson");
  EXPECT_EQ(redirect->status, 307);
  EXPECT_EQ(redirect->get_header_value("Location"),
            "/api/v1/sites/lot/compare?from=1&to=2&format=geojson");
}

TEST_F(Comparisons, RefuseWhatDoesNotExist) {
  ExpectProblem(Compare(""), 400, "invalid_input");
  ExpectProblem(Compare("?from=1&to=one"), 400, "invalid_input");
  ExpectProblem(Compare("?from=1&to=2&format=docx"), 400, "invalid_input");
  ExpectProblem(Compare("?from=1&to=9"), 404, "not_found");
  ExpectProblem(client().Get("/api/v1/sites/none/compare?from=1&to=2"), 404, "not_found");
  EXPECT_EQ(num_made_, 0);
}

class ComparisonsThatAreKilled : public Comparisons {
 protected:
  ComparisonsThatAreKilled() {
    options_.compare_command = [of_pair = options_.compare_command,
                                is_first = std::make_shared<std::atomic<bool>>(true)](
                                   const auto& from, const auto& to, const auto& out) {
      const std::string half = "mkdir -p " + out.string() + " && kill -KILL $$";
      return is_first->exchange(false) ? std::vector<std::string>{"/bin/sh", "-c", half}
                                       : of_pair(from, to, out);
    };
  }
};

TEST_F(ComparisonsThatAreKilled, AreMadeAnewForTheNextWhoAsks) {
  ExpectProblem(Compare("?from=1&to=2"), 500, "internal");
  for (const std::string& name : ContentOf(options_.data / "tmp"))
    ADD_FAILURE() << name << " was left";

  EXPECT_EQ(Get("/api/v1/sites/lot/compare?from=1&to=2").at("free_space").at("gained"), 0);
  EXPECT_EQ(Compare("?from=1&to=2&format=png")->status, 200);
  EXPECT_EQ(num_made_, 1);
}

class ComparisonsOfMergedMaps : public Comparisons {
 protected:
  ComparisonsOfMergedMaps() { options_.merge_drives = true; }
};

TEST_F(ComparisonsOfMergedMaps, PassOnWhyTheyCannotBeMade) {
  const auto answer = Compare("?from=1&to=2");
  ExpectProblem(answer, 400, "invalid_input");
  EXPECT_EQ(Json::parse(answer->body).at("detail"),
            "nothing says how the two maps lie to each other");
}

}  // namespace
}  // namespace parkade
