#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "server/store/store.h"
#include "server/webhooks/post.h"

namespace parkade {

struct WebhookOptions {
  PostLimits limits;
  /// Before a delivery that failed is tried again: after the first failure, the second, ... Given
  /// up after the last. Each is drawn a fifth longer or shorter, so that deliveries that failed
  /// together do not come back together.
  std::vector<std::chrono::milliseconds> pauses = {
      std::chrono::seconds(10), std::chrono::minutes(1), std::chrono::minutes(5),
      std::chrono::minutes(30), std::chrono::hours(2),   std::chrono::hours(6)};
};

/// Delivers what waits in the table of deliveries, in a thread of its own: every delivery at least
/// once, each webhook one at a time and all webhooks beside each other, so that a receiver that
/// does not answer holds up none of the others.
class WebhookSender {
 public:
  /// Borrows the store.
  WebhookSender(Store& store, WebhookOptions options);
  /// Breaks off what is under way: the next sender delivers it.
  ~WebhookSender();
  WebhookSender(const WebhookSender&) = delete;
  WebhookSender& operator=(const WebhookSender&) = delete;

  /// Says that there is something to deliver; it is found within a second anyway.
  void Wake();

 private:
  class Multi;

  void Work();
  void StartDue();
  void FinishDone();
  void Record(Delivery delivery, const PostResult& result);
  std::chrono::milliseconds PauseAfter(int attempts);

  Store& store_;
  const WebhookOptions options_;
  std::unique_ptr<Multi> multi_;
  std::map<std::string, std::unique_ptr<Post>> under_way_;  ///< by webhook
  std::minstd_rand random_;
  std::thread thread_;
};

}  // namespace parkade
