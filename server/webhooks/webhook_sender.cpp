#include "server/webhooks/webhook_sender.h"

#include <curl/curl.h>

#include <atomic>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "core/log.h"
#include "server/store/tables/names.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLookInterval{1000};
constexpr milliseconds kPauseAfterError{5000};  // of the database: a full disk, most likely
constexpr int kShortest = 80, kLongest = 120;   // [percent] of a pause

/// curl's own state, made once and never undone: other threads may use it.
void StartCurl() {
  static const CURLcode started = curl_global_init(CURL_GLOBAL_DEFAULT);
  Require(started == CURLE_OK, ErrorCode::kInternal, "curl does not start");
}

}  // namespace

/// Transfers that go on beside each other.
class WebhookSender::Multi {
 public:
  Multi() {
    StartCurl();
    handle_ = curl_multi_init();
    Require(handle_ != nullptr, ErrorCode::kInternal, "curl does not start");
  }
  ~Multi() { curl_multi_cleanup(handle_); }
  Multi(const Multi&) = delete;
  Multi& operator=(const Multi&) = delete;

  void Add(const Post& post) { curl_multi_add_handle(handle_, post.handle()); }
  void Remove(const Post& post) { curl_multi_remove_handle(handle_, post.handle()); }

  /// Goes on with all `num_transfers`, and returns when one did or `patience` is over.
  void Drive(size_t num_transfers, milliseconds patience) {
    int num_running = 0;
    curl_multi_perform(handle_, &num_running);
    if (static_cast<size_t>(num_running) < num_transfers) return;
    curl_multi_poll(handle_, nullptr, 0, static_cast<int>(patience.count()), nullptr);
    curl_multi_perform(handle_, &num_running);
  }

  /// Goes on with none, until it is woken or `patience` is over.
  void Rest(milliseconds patience) {
    curl_multi_poll(handle_, nullptr, 0, static_cast<int>(patience.count()), nullptr);
  }

  /// The next transfer that has ended, with curl's code; null where there is none.
  std::pair<Post*, int> NextDone() {
    int num_left = 0;
    while (const CURLMsg* message = curl_multi_info_read(handle_, &num_left)) {
      if (message->msg != CURLMSG_DONE) continue;
      const CURLcode code = message->data.result;
      Post* post = nullptr;
      curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &post);
      return {post, code};
    }
    return {nullptr, 0};
  }

  void Wake() { curl_multi_wakeup(handle_); }
  std::atomic<bool> is_stopping = false;

 private:
  CURLM* handle_ = nullptr;
};

WebhookSender::WebhookSender(Store& store, WebhookOptions options)
    : store_(store),
      options_(std::move(options)),
      multi_(std::make_unique<Multi>()),
      random_(std::random_device{}()),
      thread_([this] { Work(); }) {}

WebhookSender::~WebhookSender() {
  multi_->is_stopping = true;
  multi_->Wake();
  thread_.join();
  for (const auto& [webhook, post] : under_way_) multi_->Remove(*post);
}

void WebhookSender::Wake() { multi_->Wake(); }

void WebhookSender::Work() {
  while (!multi_->is_stopping) {
    try {
      StartDue();
      multi_->Drive(under_way_.size(), kLookInterval);
      FinishDone();
    } catch (const DiskFailure& failure) {
      store_.database.Freeze(failure.what());
      return;
    } catch (const std::exception& error) {
      LogError(std::string("webhooks error=") + error.what());
      for (auto rest = kPauseAfterError; rest > milliseconds{0} && !multi_->is_stopping;
           rest -= kLookInterval)
        multi_->Rest(kLookInterval);
    }
  }
}

void WebhookSender::StartDue() {
  const auto due = store_.database.Read([&](Connection& connection) {
    std::vector<std::pair<Webhook, Delivery>> found;
    for (Delivery& delivery : DueDeliveries(connection, NowUtc()))
      if (!under_way_.contains(delivery.webhook))
        found.emplace_back(FindWebhook(connection, delivery.webhook), std::move(delivery));
    return found;
  });
  for (const auto& [webhook, delivery] : due) {
    auto post = std::make_unique<Post>(webhook, delivery, options_.limits);
    multi_->Add(*post);
    under_way_[webhook.id] = std::move(post);
  }
}

void WebhookSender::FinishDone() {
  for (auto [post, code] = multi_->NextDone(); post != nullptr;
       std::tie(post, code) = multi_->NextDone()) {
    const PostResult result = post->Finish(code);
    const Delivery delivery = post->delivery();
    multi_->Remove(*post);
    under_way_.erase(delivery.webhook);
    Record(delivery, result);
  }
}

/// A crash before this was stored sends the delivery once more: receivers know it by its id.
void WebhookSender::Record(Delivery delivery, const PostResult& result) {
  ++delivery.attempts;
  delivery.status = result.status;
  delivery.duration_ms = result.duration.count();
  delivery.error = result.error;
  const bool is_given_up = delivery.attempts > static_cast<int>(options_.pauses.size());
  if (!result.error) {
    delivery.state = DeliveryState::kDelivered;
  } else if (is_given_up) {
    delivery.state = DeliveryState::kFailed;
  } else {
    delivery.due_at = UtcIn(PauseAfter(delivery.attempts));
  }
  if (delivery.state != DeliveryState::kWaiting) delivery.finished_at = NowUtc();
  store_.database.Write([&](Connection& connection) { UpdateDelivery(connection, delivery); });
  if (result.error)
    LogWarning("webhook id=" + delivery.webhook + " delivery=" + delivery.id +
               " attempt=" + std::to_string(delivery.attempts) +
               " state=" + ToText(delivery.state) + " error=" + *result.error);
}

milliseconds WebhookSender::PauseAfter(int attempts) {
  const milliseconds pause = options_.pauses.at(static_cast<size_t>(attempts) - 1);
  return pause * std::uniform_int_distribution(kShortest, kLongest)(random_) / 100;
}

}  // namespace parkade
