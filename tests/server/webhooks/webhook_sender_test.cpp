#include "server/webhooks/webhook_sender.h"

#include <httplib.h>

#include <atomic>
#include <mutex>
#include <nlohmann/json.hpp>

#include "server/store/tables/names.h"
#include "server/store/tables/outbox.h"
#include "server/webhooks/registration.h"
#include "server/webhooks/signature.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;

/// Takes deliveries on a port of this machine, and answers as it is told.
class Receiver {
 public:
  using Answer = std::function<void(int number, httplib::Response&)>;

  explicit Receiver(Answer answer = [](int, httplib::Response&) {}) {
    server_.Post("/hook",
                 [this, answer](const httplib::Request& request, httplib::Response& response) {
                   int number = 0;
                   {
                     const std::lock_guard lock(mutex_);
                     requests_.push_back(request);
                     number = static_cast<int>(requests_.size());
                   }
                   answer(number, response);
                 });
    port_ = server_.bind_to_any_port("127.0.0.1");
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::sleep_for(1ms);
  }
  ~Receiver() {
    server_.stop();
    thread_.join();
  }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_) + "/hook"; }
  std::vector<httplib::Request> requests() const {
    const std::lock_guard lock(mutex_);
    return requests_;
  }

 private:
  httplib::Server server_;
  int port_ = 0;
  mutable std::mutex mutex_;
  std::vector<httplib::Request> requests_;
  std::thread thread_;
};

class Sender : public StoreTest {
 protected:
  Sender() {
    options_.limits.allow_private = true;
    options_.limits.timeout = 2s;
    options_.pauses = {10ms, 20ms};
  }
  Webhook Hook(const std::string& url) {
    return AddWebhook(store_, {url, {"job"}, std::nullopt}, true, "ann");
  }
  Delivery Note(const Webhook& webhook) {
    return store_.database.Write(
        [&](Connection& connection) { return NoteTest(connection, webhook.id); });
  }
  Delivery Now(const Delivery& delivery) {
    return store_.database.Read(
        [&](Connection& connection) { return FindDelivery(connection, delivery.id); });
  }
  Delivery WaitFor(const Delivery& delivery) {
    for (int i = 0; i < 3000 && Now(delivery).state == DeliveryState::kWaiting; ++i)
      std::this_thread::sleep_for(10ms);
    return Now(delivery);
  }

  WebhookOptions options_;
};

TEST_F(Sender, SignsWhatItSends) {
  const Receiver receiver;
  const Webhook webhook = Hook(receiver.url());
  const Delivery delivery = Note(webhook);
  const WebhookSender sender(store_, options_);

  const Delivery done = WaitFor(delivery);
  EXPECT_EQ(done.state, DeliveryState::kDelivered);
  EXPECT_EQ(done.status, 200);
  EXPECT_EQ(done.attempts, 1);
  EXPECT_TRUE(done.duration_ms.has_value() && done.finished_at.has_value() && !done.error);
  ASSERT_EQ(receiver.requests().size(), 1u);
  const httplib::Request request = receiver.requests()[0];
  EXPECT_EQ(request.body, delivery.body);
  EXPECT_EQ(nlohmann::json::parse(request.body).at("event"), "test");
  EXPECT_EQ(request.get_header_value("Content-Type"), "application/json");
  EXPECT_EQ(request.get_header_value("X-Parkade-Event"), "test");
  EXPECT_EQ(request.get_header_value("X-Parkade-Delivery"), delivery.id);
  const std::string timestamp = request.get_header_value("X-Parkade-Timestamp");
  EXPECT_NEAR(std::stod(timestamp), static_cast<double>(std::time(nullptr)), 60);
  EXPECT_EQ(request.get_header_value("X-Parkade-Signature"),
            "sha256=" + SignatureOf(webhook.secret, timestamp, request.body));
}

TEST_F(Sender, TriesAgainUntilTheReceiverTakesIt) {
  const Receiver receiver(
      [](int number, httplib::Response& response) { response.status = number < 3 ? 500 : 204; });
  const Delivery delivery = Note(Hook(receiver.url()));
  const WebhookSender sender(store_, options_);

  const Delivery done = WaitFor(delivery);
  EXPECT_EQ(done.state, DeliveryState::kDelivered);
  EXPECT_EQ(done.attempts, 3);
  EXPECT_EQ(done.status, 204);
  for (const httplib::Request& request : receiver.requests())
    EXPECT_EQ(request.get_header_value("X-Parkade-Delivery"), delivery.id);
}

TEST_F(Sender, GivesUpAfterTheLastPause) {
  const Receiver receiver([](int, httplib::Response& response) { response.status = 503; });
  const Delivery delivery = Note(Hook(receiver.url()));
  const WebhookSender sender(store_, options_);

  const Delivery done = WaitFor(delivery);
  EXPECT_EQ(done.state, DeliveryState::kFailed);
  EXPECT_EQ(done.attempts, 3);
  EXPECT_EQ(done.status, 503);
  EXPECT_EQ(done.error, "the receiver answered 503");
}

TEST_F(Sender, WaitsAsLongAsItSays) {
  options_.pauses = {1h};
  const Receiver receiver([](int, httplib::Response& response) { response.status = 500; });
  const Delivery delivery = Note(Hook(receiver.url()));
  {
    const WebhookSender sender(store_, options_);
    for (int i = 0; i < 3000 && Now(delivery).attempts == 0; ++i) std::this_thread::sleep_for(10ms);
  }
  const Delivery waiting = Now(delivery);
  EXPECT_EQ(waiting.state, DeliveryState::kWaiting);
  EXPECT_GE(waiting.due_at, UtcIn(45min)) << "an hour, a fifth shorter at most";
  EXPECT_LE(waiting.due_at, UtcIn(75min));
}

TEST_F(Sender, FollowsNoRedirect) {
  const Receiver other,
      receiver([&](int, httplib::Response&response) { response.set_redirect(other.url(), 307); });
  options_.pauses = {};
  const Delivery delivery = Note(Hook(receiver.url()));
  const WebhookSender sender(store_, options_);

  EXPECT_EQ(WaitFor(delivery).error, "the receiver answered 307");
  EXPECT_TRUE(other.requests().empty());
}

TEST_F(Sender, ReadsLittleOfALongAnswer) {
  std::atomic<bool> is_cut = false;
  const Receiver receiver([&](int, httplib::Response& response) {
    response.set_chunked_content_provider("text/plain", [&](size_t, httplib::DataSink& sink) {
      const std::string piece(1 << 16, 'x');
      if (!sink.write(piece.data(), piece.size())) is_cut = true;
      return !is_cut;
    });
  });
  const Delivery delivery = Note(Hook(receiver.url()));
  const WebhookSender sender(store_, options_);

  const Delivery done = WaitFor(delivery);
  EXPECT_EQ(done.state, DeliveryState::kDelivered) << "its status says that it was taken";
  for (int i = 0; i < 500 && !is_cut; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_TRUE(is_cut);
}

TEST_F(Sender, AReceiverThatDoesNotAnswerHoldsUpNobody) {
  options_.limits.timeout = 1500ms;
  options_.pauses = {};
  std::atomic<bool> is_over = false;
  const Receiver silent([&](int, httplib::Response&) {
    while (!is_over) std::this_thread::sleep_for(10ms);
  });
  const Receiver other;
  const Webhook dead = Hook(silent.url()), refusing = Hook("http://127.0.0.1:1/hook");
  const Delivery unanswered = Note(dead), refused = Note(refusing);
  for (int i = 0; i < 5; ++i) Note(dead);
  WebhookSender sender(store_, options_);
  for (int i = 0; i < 20 && silent.requests().empty(); ++i) std::this_thread::sleep_for(50ms);

  const auto begin = std::chrono::steady_clock::now();
  const Delivery taken = Note(Hook(other.url()));
  sender.Wake();
  EXPECT_EQ(WaitFor(taken).state, DeliveryState::kDelivered);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 1400ms);
  EXPECT_EQ(silent.requests().size(), 1u) << "one at a time";
  EXPECT_EQ(WaitFor(unanswered).error, "the receiver did not answer in time");
  EXPECT_EQ(WaitFor(refused).error->substr(0, 10), "not sent: ");
  is_over = true;
}

TEST_F(Sender, ConnectsToNoPrivateAddress) {
  options_.limits.allow_private = false;
  options_.pauses = {};
  const Receiver receiver;
  std::string by_name = receiver.url();
  by_name.replace(by_name.find("127.0.0.1"), 9, "localhost");
  const Delivery number = Note(Hook(receiver.url())), name = Note(Hook(by_name));
  const WebhookSender sender(store_, options_);

  for (const Delivery& delivery : {number, name})
    EXPECT_EQ(WaitFor(delivery).error,
              "the address is private: --webhook-private lets the service send there");
  EXPECT_TRUE(receiver.requests().empty());
}

TEST_F(Sender, UsesNoProxyOfTheEnvironment) {
  const Receiver proxy, receiver;
  ::setenv("http_proxy", proxy.url().c_str(), 1);
  const Delivery delivery = Note(Hook(receiver.url()));
  {
    const WebhookSender sender(store_, options_);
    EXPECT_EQ(WaitFor(delivery).state, DeliveryState::kDelivered);
  }
  ::unsetenv("http_proxy");
  EXPECT_EQ(receiver.requests().size(), 1u);
}

TEST_F(Sender, TheNextOneDeliversWhatWasBrokenOff) {
  options_.limits.timeout = 60s;
  std::atomic<bool> is_over = false;
  const Receiver receiver([&](int number, httplib::Response&) {
    while (number == 1 && !is_over) std::this_thread::sleep_for(10ms);
  });
  const Webhook webhook = Hook(receiver.url());
  const Delivery first = Note(webhook), second = Note(webhook);
  {
    const WebhookSender sender(store_, options_);
    for (int i = 0; i < 500 && receiver.requests().empty(); ++i) std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(Now(first).state, DeliveryState::kWaiting);
  const WebhookSender sender(store_, options_);
  EXPECT_EQ(WaitFor(first).state, DeliveryState::kDelivered);
  EXPECT_EQ(WaitFor(second).state, DeliveryState::kDelivered);
  is_over = true;
}

}  // namespace
}  // namespace parkade
