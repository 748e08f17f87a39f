#include "server/http/routes/accel_redirect.h"

#include "core/files/file.h"
#include "tests/server/http/access/guarded_service.h"

namespace parkade {
namespace {

class HandedOverFiles : public GuardedService {
 protected:
  HandedOverFiles() {
    options_.proxy_host = "maps.example.org";
    options_.accel_redirect = "/files/";
  }

  void SetUp() override { Become("admin"); }

  httplib::Result Ask(const std::string& path, const std::string& host = "maps.example.org:443",
                      httplib::Headers headers = {}) {
    headers.emplace("Host", host);
    return client().Get(path, headers);
  }
  std::filesystem::path FileOf(const httplib::Result& answer) const {
    const std::string address = answer->get_header_value("X-Accel-Redirect");
    EXPECT_TRUE(address.starts_with("/files/maps/")) << address;
    return options_.data / address.substr(std::string("/files/").size());
  }
  static void Overwrite(const std::filesystem::path& file, const std::string& content) {
    std::filesystem::permissions(file, std::filesystem::perms::owner_write,
                                 std::filesystem::perm_options::add);
    std::ofstream(file, std::ios::binary | std::ios::in).write(content.data(), 1);
  }

  const std::string mesh_ = "/api/v1/sites/lot/maps/1/map.glb";
};

TEST_F(HandedOverFiles, AreNamedToTheProxyAndSentToEverybodyElse) {
  MapNow("log ok\n");
  const auto direct = Ask(mesh_, "localhost");
  const auto proxied = Ask(mesh_);

  EXPECT_EQ(direct->body, "glTF of 1 drives");
  EXPECT_FALSE(direct->has_header("X-Accel-Redirect"));
  EXPECT_EQ(proxied->status, 200);
  EXPECT_TRUE(proxied->body.empty());
  EXPECT_EQ(ReadFile(FileOf(proxied)), direct->body);
  for (const char* field : {"ETag", "Content-Type", "Cache-Control"})
    EXPECT_EQ(proxied->get_header_value(field), direct->get_header_value(field)) << field;
  const httplib::Headers known = {{"If-None-Match", direct->get_header_value("ETag")}};
  EXPECT_EQ(Ask(mesh_, "maps.example.org", known)->status, 304);
}

TEST_F(HandedOverFiles, AreNotWhenTheyHaveChangedOnTheDisk) {
  MapNow("log ok\n");
  const std::filesystem::path file = FileOf(Ask(mesh_));

  Overwrite(file, "G");
  ExpectProblem(Ask(mesh_), 500, "damaged");
  EXPECT_FALSE(Ask(mesh_)->has_header("X-Accel-Redirect"));
  EXPECT_NE(client().Get("/metrics")->body.find("parkade_damaged_files 1"), std::string::npos);

  Overwrite(file, "g");  // whole again: sent by the service, until the damage is no longer noted
  const auto answer = Ask(mesh_);
  EXPECT_EQ(answer->body, "glTF of 1 drives");
  std::filesystem::remove(file);
  ExpectProblem(Ask(mesh_), 500, "damaged");
}

TEST_F(HandedOverFiles, NeedAProxyThatIsNamed) {
  StopService();
  options_.proxy_host = "";
  EXPECT_THROW(Service service(options_), Error);
  options_.proxy_host = "maps.example.org";
  options_.accel_redirect = "files";
  EXPECT_THROW(Service service(options_), Error);
}

}  // namespace
}  // namespace parkade
