#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "server/store/tables/delivery_table.h"
#include "server/store/tables/webhook_table.h"

namespace parkade {

/// How an attempt to deliver ended.
struct PostResult {
  std::optional<std::int64_t> status;  ///< of HTTP; nothing: no answer came
  std::chrono::milliseconds duration{};
  std::optional<std::string> error;  ///< one sentence; nothing: the receiver took it
};

struct PostLimits {
  std::chrono::milliseconds timeout{10'000};  ///< for the whole of it
  bool allow_private = false;                 ///< may connect to addresses that are not public
};

/// One attempt at a delivery, to be driven by a curl multi handle: a POST of the signed body that
/// follows no redirects, uses no proxy, checks the address that it connects to and reads at most
/// 64 KiB of the answer.
class Post {
 public:
  Post(const Webhook& webhook, Delivery delivery, const PostLimits& limits);
  ~Post();
  Post(const Post&) = delete;
  Post& operator=(const Post&) = delete;

  /// curl's easy handle, whose private pointer is this.
  void* handle() const;
  const Delivery& delivery() const { return delivery_; }

  /// Once curl is done with the transfer; `code` is its CURLcode.
  PostResult Finish(int code) const;

 private:
  struct Transfer;

  Delivery delivery_;
  std::unique_ptr<Transfer> transfer_;
};

}  // namespace parkade
