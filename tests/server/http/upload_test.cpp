#include <atomic>

#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

using Uploads = RunningService;

TEST_F(Uploads, AnswerWithTheDriveAndItsJob) {
  const auto answer = Upload("log ok\n", "?filename=Level%202.bag&site=garage");

  ASSERT_TRUE(answer);
  ASSERT_EQ(answer->status, 201) << answer->body;
  const Json json = Json::parse(answer->body);
  EXPECT_EQ(json.at("drive").at("filename"), "Level 2.bag");
  EXPECT_EQ(json.at("drive").at("name"), "Level-2");
  EXPECT_EQ(json.at("drive").at("site"), "garage");
  EXPECT_EQ(json.at("drive").at("bytes"), 7);
  EXPECT_EQ(json.at("drive").at("sha256"), Sha256Of("log ok\n"));
  EXPECT_EQ(json.at("job").at("drives").at(0), json.at("drive").at("id"));
  EXPECT_EQ(answer->get_header_value("Location"),
            "/api/v1/drives/" + json.at("drive").at("id").get<std::string>());
}

TEST_F(Uploads, BecomeAMapByThemselves) {
  const Json job = MapNow("log ok\n");

  EXPECT_EQ(job.at("state"), "done") << job;
  EXPECT_EQ(job.at("progress"), 1.0);
  EXPECT_EQ(job.at("map_version"), 1);
  const Json drive = Get("/api/v1/drives/" + job.at("drives").at(0).get<std::string>());
  EXPECT_EQ(drive.at("state"), "ready");
  EXPECT_EQ(drive.at("streams").at(0).at("topic"), "/imu");
  EXPECT_EQ(drive.at("trajectories").at("trajectory.tum"),
            "/api/v1/sites/lot/maps/1/a/trajectory.tum");
  EXPECT_EQ(client().Get(drive.at("trajectories").at("trajectory.tum").get<std::string>())->status,
            200);
}

TEST_F(Uploads, OfNothingAreRefused) {
  const auto answer = Upload("");

  ExpectProblem(answer, 400, "invalid_input");
  EXPECT_EQ(Json::parse(answer->body).at("detail"), "the upload is empty");
  EXPECT_TRUE(Files().empty());
}

TEST_F(Uploads, OfWhatIsNoLogAreRefusedByTheUsersNameAndLeaveNothing) {
  const auto answer = Upload("a shopping list", "?filename=list.bag&site=lot");

  ExpectProblem(answer, 400, "invalid_input");
  EXPECT_EQ(Json::parse(answer->body).at("detail"), "'list.bag' is not a drive log");
  EXPECT_TRUE(Files().empty());
  EXPECT_TRUE(Get("/api/v1/drives").at("items").empty());
  EXPECT_TRUE(Get("/api/v1/sites").at("items").empty());
}

TEST_F(Uploads, WithOddNamesAreRefused) {
  for (const char* query :
       {"?site=../x", "?site=a%2Fb", "?rig=-x", "?filename=a&filename=b", "?site=.x"})
    ExpectProblem(Upload("log ok\n", query), 400, "invalid_input");
  ExpectProblem(Upload("log ok\n", "?rig=unknown"), 400, "invalid_input");
  EXPECT_TRUE(Files().empty());
}

TEST_F(Uploads, AsAFormAreRefused) {
  const std::string body =
      "--b\r\nContent-Disposition: form-data; name=\"file\"\r\n\r\nlog ok\n\r\n--b--\r\n";
  ExpectProblem(client().Put("/api/v1/drives", body, "multipart/form-data; boundary=b"), 415,
                "unsupported_media_type");
}

TEST_F(Uploads, AreRefusedBeforeTheyBeginWhenTheDiskIsTooSmall) {
  options_.disk_reserve = std::int64_t{1} << 60;

  ExpectProblem(Upload("log ok\n"), 507, "disk_full");
  EXPECT_TRUE(Files().empty());
  EXPECT_EQ(client().Get("/readyz")->status, 503);
}

TEST_F(Uploads, OfManyMegabytesArriveWhole) {
  std::string content = "log ok\n";
  for (int i = 0; content.size() < 20'000'000; ++i) content += std::to_string(i * 2654435761u);

  const auto answer = Upload(content, "?filename=big.bag&site=lot");

  ASSERT_EQ(answer->status, 201);
  EXPECT_EQ(Json::parse(answer->body).at("drive").at("sha256"), Sha256Of(content));
}

TEST_F(Uploads, OfTheSameBytesAtTheSameTimeShareOneFile) {
  client();
  std::vector<std::thread> clients;
  std::atomic<int> accepted{0};
  for (int i = 0; i < 8; ++i)
    clients.emplace_back([&, i] {
      DescribedClient own("127.0.0.1", service_->port());
      const auto answer =
          own.Put("/api/v1/drives?site=lot&filename=" + std::to_string(i), "log ok\n", kLogType);
      if (answer && answer->status == 201) ++accepted;
    });
  for (std::thread& thread : clients) thread.join();

  EXPECT_EQ(accepted, 8);
  EXPECT_EQ(Get("/api/v1/drives").at("items").size(), 8u);
  std::set<std::string> logs;
  for (const std::string& file : Files())
    if (file.starts_with("logs/")) logs.insert(file);
  EXPECT_EQ(logs.size(), 1u);
}

}  // namespace
}  // namespace parkade
