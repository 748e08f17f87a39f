// A reviewer's decisions about loops and pins on their way from the request to the worker's
// command.
#include <mutex>

#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class LoopReview : public RunningService {
 protected:
  void SetUp() override {
    options_.job_command = [this, of_job = options_.job_command](const JobSpec& spec) {
      const std::lock_guard lock(mutex_);
      specs_.push_back(spec);
      return of_job(spec);
    };
    options_.check_pins = [](const std::vector<std::string>& pins,
                             const std::filesystem::path& map) {
      Require(std::filesystem::exists(map / "a" / "trajectory.tum"), ErrorCode::kInternal,
              "not the version's folder");
      Require(pins.size() > 1, ErrorCode::kInvalidInput, "a site is pinned by two points or more");
    };
    ASSERT_EQ(MapNow("log ok\n").at("state"), "done");
  }

  httplib::Result Build(const std::string& body) {
    return client().Post("/api/v1/sites/lot/maps", body, "application/json");
  }

  JobSpec LastSpec() {
    const std::lock_guard lock(mutex_);
    return specs_.back();
  }

  size_t NumAttempts() {
    const std::lock_guard lock(mutex_);
    return specs_.size();
  }

 private:
  std::mutex mutex_;  // the service asks for commands on a thread of its own
  std::vector<JobSpec> specs_;
};

TEST_F(LoopReview, BuildsAVersionFromAnotherWithoutTrackingAgain) {
  const auto queued =
      Build(R"({"from": 1, "reject_loops": ["3-17", "a:5-20"], "force_loops": ["4-18"]})");
  ASSERT_EQ(queued->status, 202) << queued->body;
  const Json job = WaitForJob(Json::parse(queued->body).at("id"));

  EXPECT_EQ(job.at("state"), "done");
  EXPECT_EQ(job.at("map_version"), 2);
  const JobSpec spec = LastSpec();
  ASSERT_TRUE(spec.from);
  EXPECT_TRUE(std::filesystem::exists(*spec.from / "a" / "trajectory.tum"))
      << "the files of version 1";
  EXPECT_EQ(spec.rejected_loops, (std::vector<std::string>{"3-17", "a:5-20"}));
  EXPECT_EQ(spec.forced_loops, std::vector<std::string>{"4-18"});
}

TEST_F(LoopReview, LinksReachTheWorkerAndAreKeptForARetry) {
  const auto queued =
      Build(R"({"from": 1, "reject_links": ["a:3~b:7"], "force_links": ["a:4~b:8", "a:5~b:9"]})");
  ASSERT_EQ(queued->status, 202) << queued->body;
  WaitForJob(Json::parse(queued->body).at("id"));

  EXPECT_EQ(LastSpec().rejected_links, std::vector<std::string>{"a:3~b:7"});
  EXPECT_EQ(LastSpec().forced_links, (std::vector<std::string>{"a:4~b:8", "a:5~b:9"}));
  EXPECT_TRUE(LastSpec().rejected_loops.empty());
}

TEST_F(LoopReview, PinsReachTheWorkerToTheLastDigit) {
  const auto queued = Build(R"({"from": 1, "pins": [
      {"point": [-1.25, 2, 0.1], "latitude": 48.137154321, "longitude": -11.576124},
      {"point": [31, -2.5, 0], "latitude": 48.1375, "longitude": -11.576, "height": 519.3, "drive": "a"}]})");
  ASSERT_EQ(queued->status, 202) << queued->body;
  WaitForJob(Json::parse(queued->body).at("id"));

  EXPECT_EQ(LastSpec().pins, (std::vector<std::string>{"-1.25,2,0.1=48.137154321,-11.576124",
                                                       "a:31,-2.5,0=48.1375,-11.576,519.3"}));

  const auto without = Build(R"({"from": 1, "pins": []})");
  WaitForJob(Json::parse(without->body).at("id"));
  EXPECT_EQ(LastSpec().pins, std::vector<std::string>()) << "an empty list takes them away";

  const auto inherited = Build(R"({"from": 1})");
  WaitForJob(Json::parse(inherited->body).at("id"));
  EXPECT_FALSE(LastSpec().pins) << "without a word they stay as the version has them";
}

TEST_F(LoopReview, WithoutAVersionStartsAfresh) {
  const auto queued = Build("");
  ASSERT_EQ(queued->status, 202) << queued->body;
  WaitForJob(Json::parse(queued->body).at("id"));

  EXPECT_FALSE(LastSpec().from);
  EXPECT_TRUE(LastSpec().rejected_loops.empty() && LastSpec().forced_loops.empty());
}

TEST_F(LoopReview, ThatMakesNoSenseStartsNoJob) {
  const size_t before = NumAttempts();
  ExpectProblem(Build(R"({"reject_loops": ["3-17"]})"), 400, "invalid_input");  // of which version?
  ExpectProblem(Build(R"({"reject_links": ["a:1~b:1"]})"), 400, "invalid_input");
  ExpectProblem(Build(R"({"from": 1, "force_links": ["-x"]})"), 400, "invalid_input");
  ExpectProblem(Build(R"({"from": "1"})"), 400, "invalid_input");  // not a number
  ExpectProblem(Build(R"({"from": 1, "force_loops": "3-17"})"), 400,
                "invalid_input");  // not a list
  ExpectProblem(Build(R"({"from": 1, "force_loops": ["--out"]})"), 400,
                "invalid_input");  // an option of the worker
  const std::string place = R"("latitude": 48, "longitude": 11)";
  const std::vector<std::string> bodies = {
      R"({"pins": []})",                                                  // of which version?
      R"({"from": 1, "pins": {}})",                                       // not a list
      R"({"from": 1, "pins": ["0,0,0=48,11"]})",                          // not objects
      R"({"from": 1, "pins": [{"point": [0, 0], )" + place + "}]}",       // not three numbers
      R"({"from": 1, "pins": [{"point": [0, 0, "0"], )" + place + "}]}",  // not numbers
      R"({"from": 1, "pins": [{"point": [0, 0, 0], "latitude": 48}]})",   // no longitude
      R"({"from": 1, "pins": [{"point": [0, 0, 0], "z": 1, )" + place + "}]}",
      R"({"from": 1, "pins": [{"point": [0, 0, 0], )" + place + "}]}",  // what check_pins refuses
  };
  for (const std::string& body : bodies) ExpectProblem(Build(body), 400, "invalid_input");
  ExpectProblem(Build(R"({"from": 7})"), 404, "not_found");
  ExpectProblem(Build(R"({"from": 1, "drives": ["0000000000000000"]})"), 400, "invalid_input");

  EXPECT_EQ(NumAttempts(), before);
  EXPECT_EQ(Get("/api/v1/sites/lot").at("versions"), Json::parse("[1]"));
}

}  // namespace
}  // namespace parkade
