#include "server/webhooks/post.h"

#include <curl/curl.h>
#include <sys/socket.h>

#include <ctime>

#include "core/error.h"
#include "server/webhooks/address_check.h"
#include "server/webhooks/signature.h"

namespace parkade {
namespace {

constexpr size_t kMaxAnswer = size_t{64} << 10;  // [bytes] of head and body

struct FreeHandle {
  void operator()(CURL* handle) const { curl_easy_cleanup(handle); }
};
struct FreeList {
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};

void Append(std::unique_ptr<curl_slist, FreeList>& headers, const std::string& line) {
  curl_slist* longer = curl_slist_append(headers.get(), line.c_str());
  Require(longer != nullptr, ErrorCode::kInternal, "no memory is left to send a delivery");
  headers.release();
  headers.reset(longer);
}

}  // namespace

struct Post::Transfer {
  std::unique_ptr<CURL, FreeHandle> easy{curl_easy_init()};
  std::unique_ptr<curl_slist, FreeList> headers;
  std::string url;
  bool allow_private = false;
  bool is_private = false;  ///< the name led to an address that is not public
  size_t num_read = 0;      ///< [bytes] of the answer
  char reason[CURL_ERROR_SIZE] = "";

  template <typename Value>
  void Set(CURLoption option, Value value) {
    Require(curl_easy_setopt(easy.get(), option, value) == CURLE_OK, ErrorCode::kInternal,
            "curl does not know option " + std::to_string(option));
  }

  /// Nothing of the answer is kept: its status says all.
  static size_t Drop(char*, size_t size, size_t count, void* self) {
    auto& read = static_cast<Transfer*>(self)->num_read;
    read += size * count;
    return read <= kMaxAnswer ? size * count : 0;
  }

  static curl_socket_t OpenSocket(void* self, curlsocktype, curl_sockaddr* address) {
    auto* transfer = static_cast<Transfer*>(self);
    if (!transfer->allow_private && !IsPublicAddress(address->addr)) {
      transfer->is_private = true;
      return CURL_SOCKET_BAD;
    }
    return ::socket(address->family, address->socktype | SOCK_CLOEXEC, address->protocol);
  }
};

Post::Post(const Webhook& webhook, Delivery delivery, const PostLimits& limits)
    : delivery_(std::move(delivery)), transfer_(std::make_unique<Transfer>()) {
  Transfer& transfer = *transfer_;
  Require(transfer.easy != nullptr, ErrorCode::kInternal, "no memory is left to send a delivery");
  transfer.url = webhook.url;
  transfer.allow_private = limits.allow_private;
  const std::string timestamp = std::to_string(std::time(nullptr));
  for (const std::string& line :
       {std::string("Content-Type: application/json"), std::string("User-Agent: parkade"),
        "X-Parkade-Event: " + delivery_.event, "X-Parkade-Delivery: " + delivery_.id,
        "X-Parkade-Timestamp: " + timestamp,
        "X-Parkade-Signature: sha256=" + SignatureOf(webhook.secret, timestamp, delivery_.body),
        std::string("Expect:")})
    Append(transfer.headers, line);
  transfer.Set(CURLOPT_URL, transfer.url.c_str());
  transfer.Set(CURLOPT_PROTOCOLS_STR, "http,https");
  transfer.Set(CURLOPT_PROXY, "");  // a proxy of the environment would connect wherever it likes
  transfer.Set(CURLOPT_FOLLOWLOCATION, 0L);
  transfer.Set(CURLOPT_NOSIGNAL, 1L);
  transfer.Set(CURLOPT_QUICK_EXIT, 1L);  // a name that does not resolve holds nobody up
  transfer.Set(CURLOPT_FORBID_REUSE, 1L);
  transfer.Set(CURLOPT_TIMEOUT_MS, static_cast<long>(limits.timeout.count()));
  transfer.Set(CURLOPT_HTTPHEADER, transfer.headers.get());
  transfer.Set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(delivery_.body.size()));
  transfer.Set(CURLOPT_POSTFIELDS, delivery_.body.c_str());
  transfer.Set(CURLOPT_WRITEFUNCTION, &Transfer::Drop);
  transfer.Set(CURLOPT_WRITEDATA, transfer_.get());
  transfer.Set(CURLOPT_HEADERFUNCTION, &Transfer::Drop);
  transfer.Set(CURLOPT_HEADERDATA, transfer_.get());
  transfer.Set(CURLOPT_OPENSOCKETFUNCTION, &Transfer::OpenSocket);
  transfer.Set(CURLOPT_OPENSOCKETDATA, transfer_.get());
  transfer.Set(CURLOPT_ERRORBUFFER, transfer.reason);
  transfer.Set(CURLOPT_PRIVATE, this);
}

Post::~Post() = default;

void* Post::handle() const { return transfer_->easy.get(); }

PostResult Post::Finish(int code) const {
  PostResult result;
  curl_off_t microseconds = 0;
  long status = 0;
  curl_easy_getinfo(transfer_->easy.get(), CURLINFO_TOTAL_TIME_T, &microseconds);
  curl_easy_getinfo(transfer_->easy.get(), CURLINFO_RESPONSE_CODE, &status);
  result.duration = std::chrono::milliseconds(microseconds / 1000);
  const bool has_answered = status >= 200 && (code == CURLE_OK || transfer_->num_read > kMaxAnswer);
  if (has_answered) {
    result.status = status;
    if (status > 299) result.error = "the receiver answered " + std::to_string(status);
  } else if (transfer_->is_private) {
    result.error = "the address is private: --webhook-private lets the service send there";
  } else if (code == CURLE_OPERATION_TIMEDOUT) {
    result.error = "the receiver did not answer in time";
  } else {
    const char* words = curl_easy_strerror(static_cast<CURLcode>(code));
    result.error = std::string("not sent: ") + (transfer_->reason[0] ? transfer_->reason : words);
  }
  return result;
}

}  // namespace parkade
