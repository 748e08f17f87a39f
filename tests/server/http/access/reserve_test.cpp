// What strangers can take of the service's threads, and what they leave.

#include "tests/server/http/access/guarded_service.h"
#include "tests/server/http/raw_client.h"

namespace parkade {
namespace {

using std::chrono::steady_clock;

class Reserve : public GuardedService {
 protected:
  std::int64_t NumBusy(const std::string& route_class) {
    const std::string text = Ask("GET", "/metrics", "admin")->body;
    const std::string name = "\nparkade_http_threads_busy{class=\"" + route_class + "\"} ";
    const size_t at = text.find(name);
    return at == std::string::npos ? -1 : std::stoll(text.substr(at + name.size()));
  }
};

TEST_F(Reserve, IsLeftToThoseWhoAreKnown) {
  options_.num_threads = 4;  // 32 for downloads
  options_.web_root = root_.path() / "web";
  WriteText(options_.web_root / "index.html", "<!doctype html>");
  WriteText(options_.web_root / "large.js", std::string(size_t{32} << 20, ' '));
  ASSERT_EQ(Ask("GET", "/api/v1/drives", "viewer")->status, 200);
  std::vector<std::unique_ptr<RawClient>> strangers;  // that read nothing of what they asked for
  for (int i = 0; i < 40; ++i) {
    strangers.push_back(std::make_unique<RawClient>(service_->port()));
    strangers.back()->Send("GET /large.js HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  Eventually([&] { return NumBusy("downloads") == 24; });

  const auto began = steady_clock::now();
  EXPECT_EQ(Ask("GET", "/index.html", "viewer")->status, 200);
  EXPECT_LT(steady_clock::now() - began, std::chrono::seconds(1));
  EXPECT_EQ(NumBusy("downloads"), 24);
}

}  // namespace
}  // namespace parkade
