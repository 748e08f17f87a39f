// What the service does when its disk fails, rots or is full.

#include <fstream>

#include "core/files/sha256.h"
#include "tests/server/http/service_process.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

Json Parsed(const httplib::Result& answer) {
  return answer ? Json::parse(answer->body, nullptr, false) : Json();
}

/// Turns one bit of a file that nobody is meant to write.
void Rot(const fs::path& file, std::int64_t at) {
  fs::permissions(file, fs::perms::owner_write, fs::perm_options::add);
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekg(at);
  const int byte = stream.get();
  stream.seekp(at);
  stream.put(static_cast<char>(byte ^ 4));
}

class DiskFault : public RunningService {
 protected:
  fs::path LogFile(const std::string& content) const {
    return options_.data / "logs" / Sha256Of(content).substr(0, 2) / Sha256Of(content);
  }
  fs::path MapFile(const std::string& name) const {
    return fs::directory_iterator(options_.data / "maps")->path() / name;
  }
  std::int64_t DamagedFiles() {
    const std::string text = client().Get("/metrics")->body;
    const std::string name = "\nparkade_damaged_files ";
    return std::stoll(text.substr(text.find(name) + name.size()));
  }
};

TEST_F(DiskFault, AnUploadMendsALogThatRotted) {
  const std::string log = "log ok\nfirst light\n";
  MapNow(log);
  Rot(LogFile(log), 9);

  EXPECT_EQ(Upload(log)->status, 201);

  EXPECT_EQ(ReadFile(LogFile(log)), log);
}

TEST_F(DiskFault, AFileOfAMapThatRottedIsNotServed) {
  MapNow("log ok\n");
  const std::string address = "/api/v1/sites/lot/maps/1/map.glb";
  const auto whole = client().Get(address);
  ASSERT_EQ(whole->status, 200);
  Rot(MapFile("map.glb"), 3);

  ExpectProblem(client().Get(address), 500, "damaged");
  ExpectProblem(client().Get(address, {{"Range", "bytes=5-7"}}), 500, "damaged");
  EXPECT_EQ(DamagedFiles(), 1);
  fs::remove(MapFile("map.glb"));
  ExpectProblem(client().Get(address), 500, "damaged");
}

TEST_F(DiskFault, WhatIsGoneIsFoundAtTheStart) {
  const std::string log = "log ok\n";
  MapNow(log);
  StopService();
  client_.reset();
  fs::remove(LogFile(log));
  fs::remove_all(fs::directory_iterator(options_.data / "maps")->path());

  Start();

  const auto files = static_cast<std::int64_t>(Get("/api/v1/sites/lot/maps/1").at("files").size());
  Eventually([&] { return DamagedFiles() == files + 1; });
  EXPECT_EQ(Upload(log)->status, 201);
  EXPECT_EQ(DamagedFiles(), files);
}

TEST_F(DiskFault, AJobOnALogThatRottedDoesNotEndDone) {
  const std::string log = "log ok\n";
  const std::string drive = Parsed(Upload(log)).at("drive").at("id");
  Eventually([&] { return Get("/api/v1/drives/" + drive).at("state") == "ready"; });
  Rot(LogFile(log), 5);

  const auto queued = client().Post("/api/v1/sites/lot/maps", R"({"drives": [")" + drive + "\"]}",
                                    "application/json");
  ASSERT_EQ(queued->status, 202) << queued->body;
  const Json job = WaitForJob(Parsed(queued).at("id"));

  EXPECT_EQ(job.at("state"), "failed");
  EXPECT_EQ(job.at("error_code"), "internal");
  EXPECT_NE(job.at("error").get<std::string>().find("upload it again"), std::string::npos);
}

/// A service whose disk fails at one of its syncs, and the next one, whose does not.
/// It ends by itself, with a status that is not 0, so that there is nobody to acknowledge anything.
class FailingSync : public testing::TestWithParam<int> {
 protected:
  TemporaryRoot root_;
  fs::path data_ = root_.path() / "data", mark_ = root_.path() / "mark";
};

TEST_P(FailingSync, EndsTheServiceWithNothingLostOrHalfThere) {
  std::vector<std::string> kept;  // drives that were acknowledged
  {
    ::setenv("FAIL_SYNC", std::to_string(GetParam()).c_str(), 1);
    ::setenv("FAIL_SYNC_MARK", mark_.c_str(), 1);
    ServiceProcess service(data_);
    ::unsetenv("FAIL_SYNC");
    ::unsetenv("FAIL_SYNC_MARK");
    Eventually(
        [&] { return fs::exists(mark_) || service.Said().find("listening") != std::string::npos; });
    for (int i = 0; i < 10 && !fs::exists(mark_); ++i) {
      DescribedClient client("127.0.0.1", service.Port());
      const std::string log = "log ok\n" + std::to_string(i);
      const auto answer = client.Put("/api/v1/drives?site=lot", log, kLogType);
      if (answer && answer->status == 201) kept.push_back(Parsed(answer).at("drive").at("id"));
    }
    ASSERT_TRUE(fs::exists(mark_)) << "there were fewer syncs";
    ASSERT_TRUE(Eventually([&] { return service.HasEnded(); })) << "goes on after a failed sync";
    const int status = service.Wait();
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) != 0) << status;
  }
  ServiceProcess service(data_);
  DescribedClient client("127.0.0.1", service.Port());
  const Json drives = Parsed(client.Get("/api/v1/drives")).at("items");
  for (const Json& drive : drives) {
    const std::string sha256 = drive.at("sha256");
    EXPECT_EQ(Sha256OfFile(data_ / "logs" / sha256.substr(0, 2) / sha256), sha256);
    Eventually([&] {
      return Parsed(client.Get("/api/v1/drives/" + drive.at("id").get<std::string>()))
                 .at("state") == "ready";
    });
  }
  for (const std::string& id : kept)
    EXPECT_EQ(client.Get("/api/v1/drives/" + id)->status, 200) << "lost what it acknowledged";
}

INSTANTIATE_TEST_SUITE_P(First20, FailingSync, testing::Range(1, 21));

}  // namespace
}  // namespace parkade
