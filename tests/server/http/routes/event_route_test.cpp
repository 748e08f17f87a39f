#include "tests/server/http/raw_client.h"
#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class Events : public RunningService {
 protected:
  std::unique_ptr<RawClient> Listen(const std::string& fields = "") {
    client();
    auto listener = std::make_unique<RawClient>(service_->port());
    listener->Send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n" + fields + "\r\n");
    EXPECT_NE(listener->ReceiveUntil("retry: 2000").find("text/event-stream"), std::string::npos);
    return listener;
  }
};

TEST_F(Events, TellOfJobsDrivesAndMaps) {
  const auto listener = Listen();
  MapNow("log ok\n");

  const std::string text = listener->ReceiveUntil("event: map");
  EXPECT_NE(text.find("event: drive\n"), std::string::npos);
  EXPECT_NE(text.find("event: job\n"), std::string::npos);
  EXPECT_NE(listener->ReceiveUntil("\"version\":1").find("\"url\":\"/api/v1/sites/lot/maps/1\""),
            std::string::npos);
}

TEST_F(Events, GoOnWhereTheListenerLeft) {
  const auto listener = Listen();
  MapNow("log ok\n");
  const std::string text = listener->ReceiveUntil("event: map\n");
  const size_t id = text.find("id: ") + 4;
  const std::string first = text.substr(id, text.find('\n', id) - id);
  listener->Close();

  const auto again = Listen("Last-Event-ID: " + first + "\r\n");
  const std::string rest = again->ReceiveUntil("event: map\n");
  EXPECT_NE(rest.find("event: job\n"), std::string::npos);
  EXPECT_EQ(rest.find("id: " + first + "\n"), std::string::npos);
  EXPECT_EQ(rest.find("event: reload"), std::string::npos);
}

TEST_F(Events, AskAListenerToReloadWhoMissedTooMuch) {
  for (const char* id : {"1", "nonsense", "99999999999999"}) {
    const auto listener = Listen(std::string("Last-Event-ID: ") + id + "\r\n");
    EXPECT_NE(listener->ReceiveUntil("event: reload\n").find("event: reload\n"), std::string::npos)
        << id;
  }
}

TEST_F(Events, AreForALimitedNumberOfListeners) {
  std::vector<std::unique_ptr<RawClient>> listeners;
  for (int i = 0; i < 32; ++i) listeners.push_back(Listen());

  const auto refused = client().Get("/api/v1/events");
  ExpectProblem(refused, 503, "busy");
  EXPECT_EQ(refused->get_header_value("Retry-After"), "10");
  EXPECT_EQ(client().Get("/healthz")->status, 200);
}

TEST_F(Events, LetAListenerGoAsSoonAsItLeaves) {
  options_.num_threads = 4;  // places for two
  std::vector<std::unique_ptr<RawClient>> listeners;
  for (int i = 0; i < 2; ++i) listeners.push_back(Listen());
  ExpectProblem(client().Get("/api/v1/events"), 503, "busy");
  const auto began = std::chrono::steady_clock::now();
  listeners.front()->Close();
  const auto is_free = [&] {
    return client().Get("/metrics")->body.find("parkade_event_clients 1\n") != std::string::npos;
  };
  EXPECT_TRUE(Eventually(is_free));
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(3));
  Listen();
}

TEST_F(Events, DoNotHoldUpTheEndOfTheService) {
  const auto listener = Listen();
  const auto began = std::chrono::steady_clock::now();
  StopService();
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(3));
}

}  // namespace
}  // namespace parkade
