#include "core/error.h"
#include "server/http/routes/basemap.h"
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

TEST_F(Viewer, HasAnAddressForEachPlace) {
  for (const char* path : {"/sites", "/sites/lot.v2", "/sites/lot/maps/latest?tab=loops",
                           "/sites/a%2Fb/compare?from=1&to=2", "/drives/1a2b", "/jobs", "/rigs/car",
                           "/upload", "/review", "/settings/access"})
    EXPECT_EQ(client().Get(path)->body, "<!doctype html>") << path;
}

TEST_F(Viewer, IsSentPackedToWhomTakesIt) {
  const std::string script(20000, ';');
  WriteText(options_.web_root / "assets" / "long-3c4d.js", script);
  client().set_decompress(false);
  const auto packed = client().Get("/assets/long-3c4d.js", {{"Accept-Encoding", "br, gzip;q=0.5"}});
  EXPECT_EQ(packed->get_header_value("Content-Encoding"), "gzip");
  EXPECT_EQ(packed->get_header_value("Vary"), "Accept-Encoding");
  EXPECT_LT(packed->body.size(), 500);
  for (const char* accepted : {"identity", "br", "gzip;q=0, br"}) {
    const auto plain = client().Get("/assets/long-3c4d.js", {{"Accept-Encoding", accepted}});
    EXPECT_FALSE(plain->has_header("Content-Encoding")) << accepted;
    EXPECT_EQ(plain->body, script) << accepted;
  }
  client().set_decompress(true);  // another program's reader
  EXPECT_EQ(client().Get("/assets/long-3c4d.js", {{"Accept-Encoding", "gzip"}})->body, script);
}

TEST_F(Viewer, GivesOutNothingElse) {
  client();
  for (const char* path :
       {"/secret.txt", "/link.txt", "/../secret.txt", "/assets/../../secret.txt",
        "/..%2fsecret.txt", "/assets/none.js", "/.git", "/sitesque", "/assets", "/assets/none"}) {
    const auto answer = client().Get(path);
    ASSERT_TRUE(answer) << path;
    EXPECT_EQ(answer->body.find("secret\n"), std::string::npos) << path;
    EXPECT_EQ(answer->status, 404) << path;
  }
  ExpectProblem(client().Get("/api/v2"), 404, "not_found");
}

TEST_F(Viewer, GivesAPersonThePageWhereAnAddressLeadsNowhere) {
  const httplib::Headers person = {{"Accept", "text/html,application/xhtml+xml,*/*;q=0.8"}};
  const auto page = client().Get("/"), lost = client().Get("/nowhere/else", person);
  ASSERT_TRUE(page);
  ASSERT_TRUE(lost);
  EXPECT_EQ(lost->status, 404);
  EXPECT_EQ(lost->body, page->body);
  ExpectProblem(client().Get("/nowhere/else"), 404, "not_found");
  ExpectProblem(client().Get("/api/v1/nowhere", person), 404, "not_found");
}

TEST_F(Viewer, HasNoBasemapUnlessOneIsNamed) {
  EXPECT_EQ(client().Get("/viewer.json")->body, R"({"basemap":null})");
  EXPECT_EQ(client().Get("/basemap.pmtiles")->status, 404);
}

TEST_F(Viewer, LaysTilesFromElsewhereBelowSites) {
  options_.basemap = {"https://tiles.example:8443/{z}/{x}/{y}.png", "somebody"};
  const auto answer = client().Get("/viewer.json");
  EXPECT_EQ(nlohmann::json::parse(answer->body).at("basemap"),
            (nlohmann::json{{"tiles", options_.basemap.source}, {"attribution", "somebody"}}));
  const std::string policy = answer->get_header_value("Content-Security-Policy");
  EXPECT_NE(policy.find("img-src 'self' blob: data: https://tiles.example:8443;"),
            std::string::npos);
}

TEST_F(Viewer, SendsRangesOfABasemapOfItsOwn) {
  options_.basemap.source = (root_.path() / "town.pmtiles").string();
  WriteText(options_.basemap.source, "PMTiles\x03 and its tiles");
  EXPECT_EQ(client().Get("/viewer.json")->body,
            R"({"basemap":{"attribution":"","pmtiles":"/basemap.pmtiles"}})");
  const auto part = client().Get("/basemap.pmtiles", {{"Range", "bytes=0-6"}});
  EXPECT_EQ(part->status, 206);
  EXPECT_EQ(part->body, "PMTiles");
}

TEST_F(Viewer, RefusesWhatIsNoBasemap) {
  WriteText(root_.path() / "old.pmtiles", "PMTiles\x02");
  for (const std::string& source :
       {(root_.path() / "old.pmtiles").string(), std::string("nowhere.pmtiles"),
        std::string("https://tiles.example/{z}/{x}.png"), std::string("https:///{z}/{x}/{y}"),
        std::string("https://a b'; script-src *//{z}/{x}/{y}")}) {
    options_.basemap.source = source;
    EXPECT_THROW(Basemap{options_.basemap}, Error) << source;
  }
}

TEST_F(Viewer, SaysHowToBeInstalled) {
  options_.web_root = root_.path() / "nowhere";
  const auto answer = client().Get("/");
  ExpectProblem(answer, 404, "not_found");
  EXPECT_NE(answer->body.find("scripts/build_web.sh"), std::string::npos);
}

}  // namespace
}  // namespace parkade
