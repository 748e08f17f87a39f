#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

using Drives = RunningService;

TEST_F(Drives, AreListedInPagesFromTheNewest) {
  for (int i = 0; i < 5; ++i)
    ASSERT_EQ(
        Upload("log ok " + std::to_string(i) + "\n", "?site=lot&filename=" + std::to_string(i))
            ->status,
        201);

  std::vector<std::string> names;
  std::string cursor;
  do {
    const Json page = Get("/api/v1/drives?limit=2" + (cursor.empty() ? "" : "&cursor=" + cursor));
    EXPECT_LE(page.at("items").size(), 2u);
    for (const Json& drive : page.at("items")) names.push_back(drive.at("name"));
    cursor = page.at("next_cursor").is_null() ? "" : page.at("next_cursor").get<std::string>();
  } while (!cursor.empty());

  EXPECT_EQ(names, (std::vector<std::string>{"4", "3", "2", "1", "0"}));
  EXPECT_EQ(Get("/api/v1/drives?site=elsewhere").at("items").size(), 0u);
  EXPECT_EQ(Get("/api/v1/sites").at("items").at(0).at("drive_count"), 5);
}

TEST_F(Drives, CarryNamesOfAnyBytesUnharmed) {
  const auto answer = Upload("log ok\n", "?site=lot&filename=%ff%fe%22%3Cscript%3E.bag");
  ASSERT_EQ(answer->status, 201);

  const Json drive = Get("/api/v1/drives").at("items").at(0);
  EXPECT_EQ(drive.at("name"), "script-");
}

TEST_F(Drives, ThatDoNotExistAreNotFound) {
  client();
  ExpectProblem(client().Get("/api/v1/drives/0123456789abcdef"), 404, "not_found");
  ExpectProblem(client().Delete("/api/v1/drives/0123456789abcdef"), 404, "not_found");
}

TEST_F(Drives, LeaveTheirMapsWhenTheyAreDeleted) {
  const Json job = MapNow("log ok\n");
  const std::string drive = job.at("drives").at(0);

  EXPECT_EQ(client().Delete("/api/v1/drives/" + drive)->status, 204);

  EXPECT_EQ(Get("/api/v1/sites/lot/maps/1").at("drives").at(0).at("id"), drive);
  EXPECT_EQ(client().Get("/api/v1/sites/lot/maps/1/map.glb")->status, 200);
  EXPECT_TRUE(Get("/api/v1/drives").at("items").empty());
  for (const std::string& file : Files()) EXPECT_FALSE(file.starts_with("logs/")) << file;
}

}  // namespace
}  // namespace parkade
