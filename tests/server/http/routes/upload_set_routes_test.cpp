#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

using httplib::Headers;

class UploadSetRoutes : public RunningService {
 protected:
  UploadSetRoutes() {
    options_.check_paths = [](const std::vector<std::string>& paths) {
      for (const std::string& path : paths)
        Require(path.ends_with(".bag"), ErrorCode::kInvalidInput, "'" + path + "' is no bag");
    };
  }

  httplib::Result Declare(const Json& declared) {
    return client().Post("/api/v1/upload-sets", declared.dump(), "application/json");
  }
  /// A tar of these begins with the path, which tells the worker of tests that it is a log.
  static Json TwoParts() {
    return {{"filename", "tour"},
            {"site", "lot"},
            {"parts",
             {{{"path", "log ok/b.bag"}, {"bytes", 6}}, {{"path", "log ok/a.bag"}, {"bytes", 5}}}}};
  }
  httplib::Result Append(const std::string& address, std::int64_t offset, const std::string& part) {
    return client().Patch(address,
                          {{"Tus-Resumable", "1.0.0"}, {"Upload-Offset", std::to_string(offset)}},
                          part, "application/offset+octet-stream");
  }
};

TEST_F(UploadSetRoutes, PartsSentByTusBecomeOneDriveWithOneJob) {
  const auto declared = Declare(TwoParts());
  ASSERT_EQ(declared->status, 201) << declared->body;
  const std::string address = declared->get_header_value("Location");
  const Json set = Json::parse(declared->body);
  EXPECT_EQ(address, "/api/v1/upload-sets/" + set.at("id").get<std::string>());
  EXPECT_EQ(set.at("state"), "receiving");
  ASSERT_EQ(set.at("parts").size(), 2u);
  EXPECT_EQ(set.at("parts").at(0).at("path"), "log ok/a.bag");
  const std::string a = set.at("parts").at(0).at("upload"), b = set.at("parts").at(1).at("upload");

  EXPECT_EQ(Append(b, 0, "bag")->status, 204);
  EXPECT_EQ(Append(a, 0, "bag a")->status, 204);
  const Json half = Get(address);
  EXPECT_EQ(half.at("parts").at(0).at("offset"), 5);
  EXPECT_EQ(half.at("parts").at(1).at("offset"), 3);
  EXPECT_EQ(half.at("job"), nullptr);
  EXPECT_EQ(Get(a).at("set"), set.at("id"));
  const auto last = Append(b, 3, " bb");
  EXPECT_EQ(last->status, 204) << last->body;

  Json done;
  Eventually([&] { return (done = Get(address)).at("state") == "done"; });
  EXPECT_EQ(WaitForJob(done.at("job")).at("state"), "done");
  const Json drives = Get("/api/v1/drives").at("items");
  ASSERT_EQ(drives.size(), 1u);
  EXPECT_EQ(drives.at(0).at("id"), done.at("drive"));
  EXPECT_EQ(drives.at(0).at("filename"), "tour");
  EXPECT_EQ(drives.at(0).at("site"), "lot");
  const auto head = client().Head(b, {{"Tus-Resumable", "1.0.0"}});
  EXPECT_EQ(head->get_header_value("Upload-Drive"), done.at("drive").get<std::string>());
  EXPECT_EQ(Get("/api/v1/jobs").at("items").size(), 1u);
}

TEST_F(UploadSetRoutes, RefuseWhatTheyCannotTake) {
  const auto refused = [&](const std::function<void(Json&)>& change) {
    Json declared = TwoParts();
    change(declared);
    return Declare(declared);
  };
  ExpectProblem(refused([](Json& set) { set["parts"][0]["bytes"] = std::int64_t{1} << 50; }), 507,
                "disk_full");
  ExpectProblem(refused([](Json& set) { set["parts"][0]["path"] = "../b.bag"; }), 400,
                "invalid_input");
  ExpectProblem(refused([](Json& set) { set["parts"][0]["path"] = "log ok/a.bag"; }), 400,
                "invalid_input");
  ExpectProblem(refused([](Json& set) { set["parts"][0]["bytes"] = "6"; }), 400, "invalid_input");
  ExpectProblem(refused([](Json& set) { set["parts"][0]["color"] = "red"; }), 400, "invalid_input");
  ExpectProblem(refused([](Json& set) { set["parts"] = "all"; }), 400, "invalid_input");
  ExpectProblem(refused([](Json& set) { set.erase("parts"); }), 400, "invalid_input");
  ExpectProblem(refused([](Json& set) { set["rig"] = "none"; }), 400, "invalid_input");
  ExpectProblem(refused([](Json& set) { set["site"] = "../x"; }), 400, "invalid_input");
  const auto unknown = refused([](Json& set) { set["parts"][1]["path"] = "a.pdf"; });
  ExpectProblem(unknown, 400, "invalid_input");
  EXPECT_NE(unknown->body.find("'a.pdf' is no bag"), std::string::npos) << unknown->body;
  ExpectProblem(client().Get("/api/v1/upload-sets/0123456789abcdef"), 404, "not_found");
  EXPECT_TRUE(std::filesystem::is_empty(options_.data / "uploads"));
}

TEST_F(UploadSetRoutes, ADamagedPartIsSentAgain) {
  Json declared = TwoParts();
  declared["parts"][1]["sha256"] = Sha256Of("bag a");
  const Json set = Json::parse(Declare(declared)->body);
  const std::string a = set.at("parts").at(0).at("upload");

  ExpectProblem(Append(a, 0, "bag x"), 460, "checksum_mismatch");

  EXPECT_EQ(Get(a).at("offset"), 0);
  EXPECT_EQ(Append(a, 0, "bag a")->status, 204);
}

TEST_F(UploadSetRoutes, ASetIsTerminatedAsAWhole) {
  const Json set = Json::parse(Declare(TwoParts())->body);
  const std::string a = set.at("parts").at(0).at("upload");
  Append(a, 0, "bag a");
  ExpectProblem(client().Delete(a, {{"Tus-Resumable", "1.0.0"}}), 409, "conflict");

  const std::string address = "/api/v1/upload-sets/" + set.at("id").get<std::string>();
  EXPECT_EQ(client().Delete(address)->status, 204);

  EXPECT_EQ(client().Get(address)->status, 404);
  EXPECT_EQ(client().Get(a)->status, 404);
  EXPECT_TRUE(std::filesystem::is_empty(options_.data / "uploads"));
}

TEST_F(UploadSetRoutes, TenThousandPartsCanBeDeclared) {
  Json declared = {{"parts", Json::array()}};
  for (int i = 0; i < 10'000; ++i)
    declared["parts"].push_back({{"path", std::string(240, 'd') + "/" + std::to_string(i) + ".bag"},
                                 {"bytes", 1},
                                 {"sha256", std::string(64, 'a')}});
  const auto answer = Declare(declared);
  ASSERT_EQ(answer->status, 201) << answer->body;
  EXPECT_EQ(Json::parse(answer->body).at("parts").size(), 10'000u);
}

}  // namespace
}  // namespace parkade
