#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class Viewer : public RunningService {
 protected:
  void SetUp() override {
    options_.web_root = root_.path() / "web";
    WriteText(options_.web_root / "index.html", "<!doctype html>");
    WriteText(options_.web_root / "assets" / "index-1a2b.js", "export {}");
    WriteText(root_.path() / "secret.txt", "secret");
    std::filesystem::create_symlink(root_.path() / "secret.txt", options_.web_root / "link.txt");
  }
};

TEST_F(Viewer, IsOnePageWithItsFiles) {
  const auto page = client().Get("/");
  EXPECT_EQ(page->status, 200);
  EXPECT_EQ(page->body, "<!doctype html>");
  EXPECT_EQ(page->get_header_value("Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(page->get_header_value("Cache-Control"), "no-cache");
  EXPECT_NE(page->get_header_value("Content-Security-Policy").find("default-src 'none'"),
            std::string::npos);
  EXPECT_EQ(page->get_header_value("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(client().Get("/", {{"If-None-Match", page->get_header_value("ETag")}})->status, 304);

  const auto script = client().Get("/assets/index-1a2b.js");
  EXPECT_EQ(script->body, "export {}");
  EXPECT_EQ(script->get_header_value("Content-Type"), "text/javascript; charset=utf-8");
  EXPECT_NE(script->get_header_value("Cache-Control").find("immutable"), std::string::npos);
  EXPECT_EQ(client().Get("/?site=lot")->body, "<!doctype html>");
  EXPECT_EQ(client().Head("/")->get_header_value("Content-Length"), "15");
}

TEST_F(Viewer, GivesOutNothingElse) {
  client();
  for (const char* path :
       {"/secret.txt", "/link.txt", "/../secret.txt", "/assets/../../secret.txt",
        "/..%2fsecret.txt", "/assets/none.js", "/.git", "/sites/lot", "/assets", "/assets/none"}) {
    const auto answer = client().Get(path);
    ASSERT_TRUE(answer) << path;
    EXPECT_EQ(answer->body.find("secret\n"), std::string::npos) << path;
    EXPECT_EQ(answer->status, 404) << path;
  }
  ExpectProblem(client().Get("/api/v2"), 404, "not_found");
}

TEST_F(Viewer, SaysHowToBeInstalled) {
  options_.web_root = root_.path() / "nowhere";
  const auto answer = client().Get("/");
  ExpectProblem(answer, 404, "not_found");
  EXPECT_NE(answer->body.find("scripts/build_web.sh"), std::string::npos);
}

}  // namespace
}  // namespace parkade
