#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class Jobs : public RunningService {
 protected:
  std::string Start(const std::string& todo) {
    const auto answer = Upload("log " + todo + "\n");
    EXPECT_EQ(answer->status, 201);
    const Json json = Json::parse(answer->body);
    drive_ = json.at("drive").at("id");
    return json.at("job").at("id");
  }
  httplib::Result Post(const std::string& path) {
    return client().Post(path, "", "application/json");
  }

  std::string drive_;
};

TEST_F(Jobs, ShowStageAndProgress) {
  const std::string id = Start("slow");

  Eventually([&] { return Get("/api/v1/jobs/" + id).at("stage") == "track"; });
  const Json job = Get("/api/v1/jobs/" + id);
  EXPECT_EQ(job.at("state"), "running");
  EXPECT_EQ(job.at("progress"), 0.25);
  EXPECT_GT(job.at("eta_seconds"), 0);
  EXPECT_EQ(job.at("attempts"), 1);
  EXPECT_EQ(Get("/api/v1/drives/" + drive_).at("state"), "processing");
  EXPECT_EQ(WaitForJob(id).at("state"), "done");
}

TEST_F(Jobs, ShowAPreviewWhileTheyRun) {
  options_.job_command = [of_job = options_.job_command](const JobSpec& spec) {
    std::ofstream(spec.preview) << "glTF of the worker";
    return of_job(spec);
  };
  const std::string id = Start("slow");
  const std::string address = "/api/v1/jobs/" + id + "/preview.glb";

  Eventually([&] { return Get("/api/v1/jobs/" + id).at("stage") == "track"; });
  const std::string first = Get("/api/v1/jobs/" + id).at("preview");
  EXPECT_TRUE(first.starts_with(address + "?written=")) << first;
  const auto preview = client().Get(first);
  EXPECT_EQ(preview->status, 200);
  EXPECT_EQ(preview->body, "glTF of the worker");
  EXPECT_EQ(preview->get_header_value("Content-Type"), "model/gltf-binary");
  EXPECT_EQ(preview->get_header_value("Cache-Control"), "no-store");
  for (const std::string& file : Files())
    if (file.ends_with("preview.glb"))
      std::filesystem::last_write_time(
          options_.data / file,
          std::filesystem::file_time_type::clock::now() + std::chrono::seconds(5));
  EXPECT_NE(Get("/api/v1/jobs/" + id).at("preview"), first) << "it was replaced";

  EXPECT_EQ(WaitForJob(id).at("state"), "done");
  EXPECT_EQ(Get("/api/v1/jobs/" + id).at("preview"), nullptr);
  ExpectProblem(client().Get(address), 404, "not_found");
  Eventually([&] {
    for (const std::string& file : Files())
      if (file.ends_with("preview.glb")) return false;
    return true;
  });
}

TEST_F(Jobs, TellWhatIsWrongWithTheInput) {
  const Json job = WaitForJob(Start("bad-input"));

  EXPECT_EQ(job.at("state"), "failed");
  EXPECT_EQ(job.at("error"), "the log has no IMU");
  EXPECT_EQ(job.at("error_code"), "invalid_input");
  EXPECT_EQ(Get("/api/v1/drives/" + drive_).at("state"), "failed");
  EXPECT_EQ(Get("/api/v1/drives/" + drive_).at("error"), "the log has no IMU");
}

TEST_F(Jobs, ThatCrashHurtNobodyElse) {
  const std::string id = Start("crash");
  while (WaitForJob(id, "queued running failed").at("state") != "failed")
    EXPECT_EQ(client().Get("/healthz")->status, 200);

  EXPECT_EQ(Get("/api/v1/jobs/" + id).at("attempts"), 3);
  EXPECT_EQ(MapNow("log ok\n").at("state"), "done");
}

TEST_F(Jobs, ThatMakeNoMapFail) {
  EXPECT_EQ(WaitForJob(Start("no-map")).at("error"), "the worker ended without 'map.glb'");
  EXPECT_EQ(WaitForJob(Start("silent")).at("error"),
            "the worker ended with status 3 and gave no reason");
  for (const std::string& file : Files()) EXPECT_FALSE(file.starts_with("maps/")) << file;
}

TEST_F(Jobs, KeepTheirLogs) {
  const std::string id = Start("bad-input");
  WaitForJob(id);

  const auto log = client().Get("/api/v1/jobs/" + id + "/log");
  EXPECT_EQ(log->status, 200);
  EXPECT_TRUE(log->body.ends_with("\nworking on a: bad-input\n")) << log->body;
  EXPECT_EQ(log->get_header_value("Content-Type"), "text/plain; charset=utf-8");
  EXPECT_EQ(client().Get("/api/v1/jobs/" + id + "/log?attempt=1")->body, log->body);
  ExpectProblem(client().Get("/api/v1/jobs/" + id + "/log?attempt=2"), 404, "not_found");
  ExpectProblem(client().Get("/api/v1/jobs/" + id + "/log?attempt=../1"), 404, "not_found");
}

TEST_F(Jobs, ThatFailSayInWhichStage) {
  EXPECT_EQ(WaitForJob(Start("bad-input")).at("stage"), "track");
  EXPECT_TRUE(WaitForJob(Start("ok")).at("stage").is_null()) << "it has done all of them";
}

TEST_F(Jobs, AreCancelledAndTriedAgain) {
  const std::string id = Start("hang");
  WaitForJob(id, "running");
  Eventually([&] { return Get("/api/v1/jobs/" + id).at("stage") == "track"; });
  ExpectProblem(client().Delete("/api/v1/drives/" + drive_), 409, "conflict");

  EXPECT_EQ(Post("/api/v1/jobs/" + id + "/cancel")->status, 202);
  EXPECT_EQ(WaitForJob(id).at("state"), "cancelled");
  EXPECT_EQ(Get("/api/v1/jobs/" + id).at("stage"), "track") << "where it ended";
  EXPECT_EQ(Get("/api/v1/drives/" + drive_).at("state"), "received");
  ExpectProblem(Post("/api/v1/jobs/" + id + "/cancel"), 409, "conflict");

  EXPECT_EQ(Post("/api/v1/jobs/" + id + "/retry")->status, 202);
  ExpectProblem(Post("/api/v1/jobs/" + id + "/retry"), 409, "conflict");
  WaitForJob(id, "running");
  EXPECT_EQ(Get("/api/v1/jobs/" + id).at("attempts"), 2);
  Eventually([&] { return Post("/api/v1/jobs/" + id + "/cancel")->status == 202; });
  WaitForJob(id);

  EXPECT_EQ(client().Delete("/api/v1/drives/" + drive_)->status, 204);
  ExpectProblem(client().Get("/api/v1/drives/" + drive_), 404, "not_found");
  ExpectProblem(Post("/api/v1/jobs/" + id + "/retry"), 409, "conflict");
  for (const std::string& file : Files()) EXPECT_FALSE(file.starts_with("logs/")) << file;
}

TEST_F(Jobs, WaitForTheirTurn) {
  const std::string first = Start("hang");
  WaitForJob(first, "running");
  const std::string second = Start("ok");
  EXPECT_EQ(Get("/api/v1/jobs/" + second).at("state"), "queued");

  Post("/api/v1/jobs/" + first + "/cancel");
  EXPECT_EQ(WaitForJob(second).at("state"), "done");
}

TEST_F(Jobs, AreListedByState) {
  WaitForJob(Start("ok"));
  WaitForJob(Start("bad-input"));

  EXPECT_EQ(Get("/api/v1/jobs").at("items").size(), 2u);
  EXPECT_EQ(Get("/api/v1/jobs?state=failed").at("items").size(), 1u);
  EXPECT_EQ(Get("/api/v1/jobs?site=elsewhere").at("items").size(), 0u);
  ExpectProblem(client().Get("/api/v1/jobs?state=odd"), 400, "invalid_input");
  for (const char* query : {"?limit=0", "?limit=201", "?limit=x", "?cursor=x"})
    ExpectProblem(client().Get(std::string("/api/v1/jobs") + query), 400, "invalid_input");
  const auto no_number = client().Get("/api/v1/jobs?limit=abc");
  EXPECT_EQ(Json::parse(no_number->body).at("detail"), "'limit' is a number from 1 to 200");
}

TEST_F(Jobs, ThatDoNotExistAreNotFound) {
  client();
  for (const char* path :
       {"/api/v1/jobs/0123456789abcdef", "/api/v1/jobs/0123456789abcdef/log", "/api/v1/jobs/x"})
    ExpectProblem(client().Get(path), 404, "not_found");
  ExpectProblem(Post("/api/v1/jobs/0123456789abcdef/cancel"), 404, "not_found");
}

}  // namespace
}  // namespace parkade
