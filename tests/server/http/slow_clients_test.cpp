// Clients that send or read byte by byte, and what others notice of them.

#include <atomic>

#include "tests/server/http/raw_client.h"
#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

using std::chrono::steady_clock;

/// Sends a byte to each of many clients' connections over and over.
class Dripper {
 public:
  Dripper(int port, int count, const std::string& beginning) {
    for (int i = 0; i < count; ++i) {
      clients_.push_back(std::make_unique<RawClient>(port));
      clients_.back()->Send(beginning);
    }
    thread_ = std::thread([this] {
      while (!is_ending_) {
        for (const auto& client : clients_) client->Send("x");
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
      }
    });
  }
  ~Dripper() {
    is_ending_ = true;
    thread_.join();
  }

 private:
  std::vector<std::unique_ptr<RawClient>> clients_;
  std::atomic<bool> is_ending_ = false;
  std::thread thread_;
};

class SlowClients : public RunningService {
 protected:
  static std::string PutHead(std::int64_t length, const std::string& fields = "") {
    return "PUT /api/v1/drives?site=lot HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
           std::to_string(length) + "\r\n" + fields + "\r\n";
  }
  /// The address of a job's log of `bytes`: a large file that the service sends.
  std::string LargeFile(size_t bytes) {
    const std::string id = MapNow("log ok\n").at("id");
    WriteText(options_.data / "jobs" / id / "attempt-1" / "log.txt", std::string(bytes, 'x'));
    return "/api/v1/jobs/" + id + "/log";
  }
  std::int64_t Metric(const std::string& name) {
    const std::string text = client().Get("/metrics")->body;
    const size_t at = text.find("\n" + name + " ");
    EXPECT_NE(at, std::string::npos) << name;
    return at == std::string::npos ? -1 : std::stoll(text.substr(at + name.size() + 2));
  }
  /// Asks for `path` in a connection of its own.
  void ExpectAnswer(const std::string& path) {
    const auto began = steady_clock::now();
    DescribedClient own("127.0.0.1", service_->port());
    const auto answer = own.Get(path);
    ASSERT_TRUE(answer) << path;
    EXPECT_EQ(answer->status, 200) << path << ": " << answer->body.substr(0, 500);
    EXPECT_LT(steady_clock::now() - began, std::chrono::seconds(1)) << path;
  }
};

TEST_F(SlowClients, StopNoOthers) {
  options_.num_threads = 8;  // two for the API
  options_.web_root = root_.path() / "web";
  WriteText(options_.web_root / "index.html", "<!doctype html>");
  const std::string file = LargeFile(size_t{32} << 20);
  std::vector<std::unique_ptr<RawClient>> readers;  // that take nothing of what they asked for
  for (int i = 0; i < 50; ++i) {
    readers.push_back(std::make_unique<RawClient>(service_->port()));
    readers.back()->Send("GET " + file + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  Eventually([&] { return Metric("parkade_http_threads_busy{class=\"downloads\"}") == 50; });
  const Dripper heads(service_->port(), 150, "GET /healthz HTTP/1.1\r\nX-Field: ");
  const Dripper bodies(service_->port(), 150, PutHead(100'000'000) + "log ok\n");
  Eventually([&] { return Metric("parkade_http_connections_waiting") >= 300; });

  for (int i = 0; i < 10; ++i)
    for (const std::string& path :
         {std::string("/healthz"), std::string("/api/v1/drives"), std::string("/"),
          std::string("/api/v1/sites/lot/maps/1/map.glb")})
      ExpectAnswer(path);
  EXPECT_EQ(Upload("log ok\n", "?site=other")->status, 201);

  EXPECT_GE(Metric("parkade_http_connections_waiting"), 300);
  EXPECT_EQ(Metric("parkade_http_threads_busy{class=\"downloads\"}"), 50);
  Eventually([&] { return Metric("parkade_http_threads_busy{class=\"uploads\"}") == 0; });
  EXPECT_EQ(Metric("parkade_http_connections_too_slow_total"), 0);
}

TEST_F(SlowClients, MakeRoomWhereOthersWait) {
  options_.num_threads = 4;  // sixteen for uploads
  client();
  std::vector<std::unique_ptr<RawClient>> stalled;
  for (int i = 0; i < 16; ++i) {
    stalled.push_back(std::make_unique<RawClient>(service_->port()));
    stalled.back()->Send(PutHead(1'000'000) + "log ok\n" + std::string(70'000, 'x'));
  }
  Eventually([&] { return Metric("parkade_http_threads_busy{class=\"uploads\"}") == 16; });

  EXPECT_EQ(Upload("log ok\n")->status, 201);
  EXPECT_EQ(Metric("parkade_http_connections_too_slow_total"), 1);
  Eventually([&] { return Metric("parkade_http_threads_busy{class=\"uploads\"}") == 15; });
}

TEST_F(SlowClients, AreEndedThoughTheyBeganFast) {
  const std::string get =
      "GET " + LargeFile(size_t{32} << 20) + " HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const std::string put = PutHead(100'000'000) + "log ok\n" + std::string(3'000'000, 'x');
  RawClient reader(service_->port()), writer(service_->port());
  RawClient steady_reader(service_->port()), steady_writer(service_->port());
  for (RawClient* client : {&reader, &steady_reader}) client->Send(get);
  for (RawClient* client : {&writer, &steady_writer}) client->Send(put);
  const auto began = steady_clock::now();
  std::atomic<bool> is_ended = false;
  std::thread drip([&] {
    std::string piece(65536, '\0');
    while (!is_ended) {
      writer.Send("x");
      steady_writer.Send(std::string(10'000, 'x'));
      EXPECT_GT(::recv(steady_reader.socket(), piece.data(), piece.size(), 0), 0);
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  });
  Eventually([&] { return Metric("parkade_http_connections_too_slow_total") >= 2; });
  EXPECT_GT(steady_clock::now() - began, std::chrono::seconds(8));
  std::this_thread::sleep_for(std::chrono::seconds(2));  // the steady ones are not next
  is_ended = true;
  drip.join();

  EXPECT_EQ(Metric("parkade_http_connections_too_slow_total"), 2);
  EXPECT_EQ(StatusOf(writer.ReceiveAll()), 400);
  EXPECT_LT(reader.ReceiveAll().size(), size_t{32} << 20);
  Eventually([&] { return Metric("parkade_http_threads_busy{class=\"uploads\"}") == 1; });
}

TEST_F(SlowClients, WhoAskBeforeTheySendAreAnsweredAtOnce) {
  client();
  RawClient raw(service_->port());
  raw.Send(PutHead(200'000, "Expect: 100-continue\r\n"));
  EXPECT_EQ(StatusOf(raw.ReceiveUntil("\r\n\r\n")), 100);
}

TEST_F(SlowClients, GetTheirWholeAnswerAtTheEndOfTheService) {
  const std::string file = LargeFile(size_t{32} << 20);
  RawClient reader(service_->port());
  reader.Send("GET " + file + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  reader.ReceiveUntil("\r\n\r\n");
  std::thread stop([this] { service_->Stop(std::chrono::seconds(30)); });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));

  EXPECT_GT(reader.ReceiveAll().size(), size_t{32} << 20);
  stop.join();
  const auto began = steady_clock::now();
  StopService();
  EXPECT_LT(steady_clock::now() - began, std::chrono::seconds(10));
}

}  // namespace
}  // namespace parkade
