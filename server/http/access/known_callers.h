#pragma once

#include <deque>
#include <mutex>
#include <string>
#include <unordered_set>

#include "server/http/request_head.h"

namespace parkade {

/// The tokens and sessions that let somebody in lately, as hashes. It tells by a request's head
/// alone, before the request has a thread, whether an identity of ours sends it: who is known waits
/// behind no stranger (RequestPool). It gives no right: a token that was revoked is still known,
/// and is refused by the Gate. Thread-safe.
class KnownCallers {
 public:
  /// What is kept of more than `capacity` secrets are those that were noted last.
  explicit KnownCallers(size_t capacity = 10'000) : capacity_(capacity) {}

  /// Notes the secret of a token or session that let somebody in.
  void Note(const std::string& secret);

  /// True where the request shows a secret that was noted.
  bool Knows(const RequestHead& head) const;

 private:
  const size_t capacity_;
  mutable std::mutex mutex_;
  std::unordered_set<std::string> hashes_;
  std::deque<std::string> order_;  ///< the oldest first
};

}  // namespace parkade
