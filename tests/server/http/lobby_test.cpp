#include "server/http/lobby.h"

#include <fcntl.h>
#include <sys/resource.h>

#include <atomic>
#include <mutex>
#include <thread>

#include "tests/server/http/raw_client.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;

/// A lobby and its pools without routes: what is asked for is answered with the length of the body,
/// below /api/ only when `gate_` is open. Known is who does not say "X-Stranger".
class LobbyTest : public testing::Test {
 protected:
  ~LobbyTest() override {
    Open();
    signal_.Cut(2s);
    if (lobby_) lobby_->Wake();
    if (thread_.joinable()) thread_.join();
    if (pools_) pools_->Join();
    ::close(listener_);
  }

  void Listen() {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    ASSERT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    ASSERT_EQ(::listen(listener_, 512), 0);
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  void Start() {
    if (listener_ < 0) Listen();
    pools_.emplace(num_threads_,
                   PoolHooks{[this](HttpConnection& connection) { Answer(connection); },
                             [this](std::unique_ptr<HttpConnection> connection) {
                               lobby_->Return(std::move(connection));
                             }},
                   metrics_);
    lobby_.emplace(
        limits_,
        EntryRules{.allows_any_host = [] { return false; },
                   .is_known = [](const RequestHead& head) { return !head.Find("x-stranger"); }},
        *pools_, signal_, metrics_);
    thread_ = std::thread([this] { lobby_->Run(listener_); });
  }
  void Open() {
    gate_ = true;
    gate_.notify_all();
  }

  std::vector<std::unique_ptr<RawClient>> Clients(int count, const std::string& text) {
    std::vector<std::unique_ptr<RawClient>> clients;
    for (int i = 0; i < count; ++i) {
      clients.push_back(std::make_unique<RawClient>(port_));
      clients.back()->Send(text);
    }
    return clients;
  }
  static std::string Request(const std::string& line, const std::string& body = "") {
    return line + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: " + std::to_string(body.size()) +
           "\r\n\r\n" + body;
  }
  static std::string StrangersRequest(const std::string& line) {
    return line + " HTTP/1.1\r\nHost: localhost\r\nX-Stranger: 1\r\n\r\n";
  }
  std::string Ask(const std::string& text, const std::string& end = "bytes") {
    RawClient client(port_);
    client.Send(text);
    return client.ReceiveUntil(end);
  }

  LobbyLimits limits_;
  Metrics metrics_;
  ShutdownSignal signal_;
  int listener_ = -1, port_ = 0;
  int num_threads_ = 8;  // two for the API
  std::atomic<bool> gate_ = false;
  std::atomic<int> num_answers_ = 0;
  size_t padding_ = 0;  // [bytes] before each answer
  std::optional<RequestPools> pools_;
  std::optional<Lobby> lobby_;
  std::thread thread_;
  std::mutex mutex_;
  std::vector<std::string> answered_;  ///< paths, guarded by mutex_

 private:
  void Answer(HttpConnection& connection) {
    if (connection.route_class() == RouteClass::kApi) gate_.wait(false);
    {
      const std::lock_guard lock(mutex_);
      answered_.push_back(connection.trace().path);
    }
    std::string text, piece(4096, '\0');
    for (ssize_t size = 1; size > 0; text += piece.substr(0, static_cast<size_t>(size)))
      if ((size = connection.read(piece.data(), piece.size())) <= 0) break;
    const std::string body =
        std::string(padding_, ' ') + std::to_string(connection.body_length()) + " bytes";
    const std::string answer =
        "HTTP/1.1 200 OK\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
    connection.write(answer.data(), answer.size());
    connection.set_keeps_alive(connection.IsBodyRead());
    ++num_answers_;
  }
};

TEST_F(LobbyTest, AnswersOneRequestAfterTheOther) {
  Start();
  RawClient client(port_);
  client.Send(Request("PUT /a", "abc"));
  EXPECT_NE(client.ReceiveUntil("bytes").find("3 bytes"), std::string::npos);
  client.Send(Request("PUT /a", std::string(1'000'000, 'x')) + Request("PUT /a", "ab"));
  const std::string answers = client.ReceiveUntil("2 bytes");
  EXPECT_NE(answers.find("1000000 bytes"), std::string::npos) << answers;
  EXPECT_NE(answers.find("2 bytes"), std::string::npos) << answers;
}

TEST_F(LobbyTest, TakesRequestsThatComeByteByByte) {
  Start();
  RawClient client(port_);
  for (const char c : Request("PUT /a", "abc")) {
    client.Send(std::string(1, c));
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_NE(client.ReceiveUntil("bytes").find("3 bytes"), std::string::npos);
}

TEST_F(LobbyTest, EndsWhatTakesTooLong) {
  limits_.head = limits_.body = 300ms;
  limits_.first_request = limits_.next_request = 100ms;
  Start();
  RawClient silent(port_), head(port_), body(port_), large(port_), answered(port_);
  head.Send("GET /healthz HT");
  body.Send("PUT /a HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10\r\n\r\nabc");
  large.Send("PUT /a HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000\r\n\r\nabc");
  answered.Send(Request("GET /healthz"));
  for (int i = 0; i < 10; ++i) {
    std::this_thread::sleep_for(20ms);
    head.Send("x");
    large.Send("x");
  }

  EXPECT_EQ(silent.ReceiveAll(), "");
  for (RawClient* late : {&head, &body, &large}) EXPECT_EQ(StatusOf(late->ReceiveAll()), 408);
  EXPECT_TRUE(answered.ReceiveAll().ends_with(" bytes"));
  EXPECT_EQ(metrics_.connections_too_slow, 3);
  EXPECT_EQ(metrics_.of(RouteClass::kDownloads).durations.count(0), 0);
}

TEST_F(LobbyTest, LetsWhoHasWaitedLongestGoWhereItIsFull) {
  limits_.max_connections = 8;
  Start();
  const auto waiting = Clients(8, "GET /healthz HT");
  while (metrics_.connections_waiting < 8) std::this_thread::sleep_for(1ms);

  EXPECT_EQ(StatusOf(Ask(Request("GET /healthz"))), 200);
  EXPECT_EQ(StatusOf(waiting[0]->ReceiveAll()), 503);
  EXPECT_EQ(metrics_.connections_refused, 1);
  waiting[1]->Send("TP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(StatusOf(waiting[1]->ReceiveUntil("bytes")), 200);
}

TEST_F(LobbyTest, HoldsALimitedNumberOfBytes) {
  limits_.max_bytes = 200'000;
  Start();
  const std::string part = "PUT /a HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000\r\n\r\n" +
                           std::string(40'000, 'x');
  const auto clients = Clients(8, part);
  EXPECT_EQ(StatusOf(clients[0]->ReceiveAll()), 503);
  std::this_thread::sleep_for(300ms);
  EXPECT_EQ(metrics_.connections_refused, 3);
}

TEST_F(LobbyTest, GoesOnWhenNoFileDescriptorIsLeft) {
  Listen();
  const auto waiting = Clients(30, "GET /healthz HT");
  RawClient last(port_);
  last.Send(Request("GET /healthz"));
  rlimit before{};
  ::getrlimit(RLIMIT_NOFILE, &before);
  const int next = ::fcntl(listener_, F_DUPFD, 0);
  ::close(next);
  rlimit few = before;
  few.rlim_cur = static_cast<rlim_t>(next) + 10;  // two of them for the lobby itself
  ::setrlimit(RLIMIT_NOFILE, &few);
  Start();
  const std::string answer = last.ReceiveUntil("bytes");
  ::setrlimit(RLIMIT_NOFILE, &before);

  EXPECT_EQ(StatusOf(answer), 200) << answer;
  EXPECT_GE(metrics_.connections_refused, 20);
}

TEST_F(LobbyTest, AnswersOtherKindsOfRequestsWhereOneIsFull) {
  Start();
  const auto busy = Clients(2 + 256, Request("GET /api/v1/drives"));
  const RouteClassMetrics& api = metrics_.of(RouteClass::kApi);
  while (api.busy + api.waiting < 2 + 256) std::this_thread::sleep_for(1ms);

  const std::string refused = Ask(Request("GET /api/v1/drives"), "\n}");
  EXPECT_EQ(StatusOf(refused), 503);
  EXPECT_NE(refused.find("Retry-After: 1\r\n"), std::string::npos) << refused;
  EXPECT_EQ(api.refused, 1);
  for (const char* path : {"/healthz", "/readyz", "/metrics", "/"})
    EXPECT_EQ(StatusOf(Ask(Request(std::string("GET ") + path))), 200) << path;
  Open();
  for (const auto& client : busy) EXPECT_EQ(StatusOf(client->ReceiveUntil("bytes")), 200);
}

TEST_F(LobbyTest, KeepsThreadsAndPlacesForWhoIsKnown) {
  num_threads_ = 16;  // four for the API
  Start();
  const RouteClassMetrics& api = metrics_.of(RouteClass::kApi);
  const auto strangers = Clients(4 + 256, StrangersRequest("GET /api/v1/drives"));
  while (api.busy + api.waiting + api.refused < 4 + 256) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(api.busy, 3);
  EXPECT_EQ(api.waiting, 192);
  EXPECT_EQ(api.refused, 65);

  const auto known = Clients(1 + 64, Request("GET /api/v1/drives"));
  while (api.busy + api.waiting < 4 + 256) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(api.busy, 4);
  EXPECT_EQ(api.refused, 65);
  Open();
  for (const auto& client : known) EXPECT_EQ(StatusOf(client->ReceiveUntil("bytes")), 200);
  int num_served = 0;
  for (const auto& client : strangers)
    if (StatusOf(client->ReceiveUntil("\r\n\r\n")) == 200) ++num_served;
  EXPECT_EQ(num_served, 3 + 192);
}

TEST_F(LobbyTest, AnswersWhoIsKnownBeforeStrangers) {
  num_threads_ = 4;  // one for the API
  Start();
  const RouteClassMetrics& api = metrics_.of(RouteClass::kApi);
  std::vector<std::unique_ptr<RawClient>> clients;
  for (const std::string& text :
       {Request("GET /api/v1/first"), StrangersRequest("GET /api/v1/stranger"),
        StrangersRequest("GET /api/v1/stranger"), Request("GET /api/v1/known")}) {
    clients.push_back(std::make_unique<RawClient>(port_));
    clients.back()->Send(text);
    while (api.busy + api.waiting < static_cast<std::int64_t>(clients.size()) || api.busy == 0)
      std::this_thread::sleep_for(1ms);
  }
  Open();
  for (const auto& client : clients) EXPECT_EQ(StatusOf(client->ReceiveUntil("bytes")), 200);

  const std::lock_guard lock(mutex_);
  EXPECT_EQ(answered_, (std::vector<std::string>{"/api/v1/first", "/api/v1/known",
                                                 "/api/v1/stranger", "/api/v1/stranger"}));
}

TEST_F(LobbyTest, LetsStrangersGoBeforeWhoIsKnown) {
  limits_.max_connections = 8;
  Start();
  const auto known = Clients(2, Request("GET /healthz"));
  for (const auto& client : known) client->ReceiveUntil("bytes");
  const auto strangers = Clients(10, StrangersRequest("GET /healthz"));
  for (const auto& client : strangers) client->ReceiveUntil("bytes");
  while (metrics_.connections_refused < 4) std::this_thread::sleep_for(1ms);

  for (const auto& client : known) {
    client->Send(Request("PUT /a", "abc"));
    EXPECT_NE(client->ReceiveUntil("3 bytes").find("3 bytes"), std::string::npos);
  }
}

TEST_F(LobbyTest, KeepsShortAnswersOfWhoReadsLate) {
  padding_ = size_t{6} << 20;  // more than the kernel takes
  limits_.max_bytes = std::int64_t{1} << 30;
  Open();
  Start();
  const auto late = Clients(5, Request("GET /api/v1/drives"));
  const auto is_free = [&] {
    return num_answers_ == 5 && metrics_.of(RouteClass::kApi).busy == 0 &&
           metrics_.connections_waiting == 5;
  };
  while (!is_free()) std::this_thread::sleep_for(1ms);

  EXPECT_EQ(metrics_.connections_too_slow, 0);
  EXPECT_GT(Ask(Request("GET /api/v1/drives")).size(), padding_);
  for (const auto& client : late) {
    EXPECT_GT(client->ReceiveUntil("0 bytes").size(), padding_);
    client->Send(Request("PUT /a", "abc"));
    EXPECT_NE(client->ReceiveUntil("3 bytes").find("3 bytes"), std::string::npos);
  }
}

TEST_F(LobbyTest, EndsWhoDoesNotReadAShortAnswer) {
  padding_ = size_t{6} << 20;
  limits_.answer = -780s;  // more than the time for six megabytes is taken off
  Open();
  Start();
  RawClient late(port_);
  late.Send(Request("GET /api/v1/drives"));
  while (metrics_.connections_too_slow < 1) std::this_thread::sleep_for(1ms);
  EXPECT_LT(late.ReceiveAll().size(), padding_);
}

TEST_F(LobbyTest, TakesWhatSendsItsBodyLaterForAnUpload) {
  Start();  // the gate of the API is shut
  const std::string head = "PUT /api/v1/x HTTP/1.1\r\nHost: localhost\r\n";
  for (const std::string& beginning :
       {head + "Expect: 100-continue\r\nContent-Length: 100000\r\n\r\n",
        head + "Content-Length: 200000\r\n\r\n" + std::string(100'000, 'x')}) {
    RawClient client(port_);
    client.Send(beginning);
    while (metrics_.of(RouteClass::kUploads).busy == 0) std::this_thread::sleep_for(1ms);
    client.Send(std::string(100'000, 'x'));
    EXPECT_EQ(StatusOf(client.ReceiveUntil("bytes")), 200);
    while (metrics_.of(RouteClass::kUploads).busy > 0) std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(metrics_.of(RouteClass::kApi).busy, 0);
}

TEST_F(LobbyTest, HandsOnWhatBrokeOffInALargeBody) {
  Start();
  RawClient client(port_);
  client.Send("PUT /a HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000\r\n\r\nabc");
  ASSERT_EQ(::shutdown(client.socket(), SHUT_WR), 0);
  EXPECT_NE(client.ReceiveUntil("bytes").find("1000000 bytes"), std::string::npos);
}

TEST_F(LobbyTest, AnswersWhoIsThereAtTheEnd) {
  limits_.first_request = 60s;
  Start();
  const auto busy = Clients(20, Request("GET /api/v1/drives"));
  const RouteClassMetrics& api = metrics_.of(RouteClass::kApi);
  while (api.busy + api.waiting < 20) std::this_thread::sleep_for(1ms);
  RawClient idle(port_), half(port_);
  half.Send("GET /healthz HT");
  while (metrics_.connections_waiting < 2) std::this_thread::sleep_for(1ms);
  signal_.Cut(20s);
  lobby_->Wake();

  EXPECT_EQ(idle.ReceiveAll(), "");
  half.Send("TP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(StatusOf(half.ReceiveUntil("bytes")), 200);
  Open();
  for (const auto& client : busy) EXPECT_EQ(StatusOf(client->ReceiveUntil("bytes")), 200);
  thread_.join();
  EXPECT_FALSE(signal_.is_over());
}

}  // namespace
}  // namespace parkade
