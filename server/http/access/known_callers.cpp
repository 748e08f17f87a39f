#include "server/http/access/known_callers.h"

#include "core/files/sha256.h"
#include "server/http/access/credentials.h"

namespace parkade {

void KnownCallers::Note(const std::string& secret) {
  const std::string hash = Sha256Of(secret);
  const std::lock_guard lock(mutex_);
  if (!hashes_.insert(hash).second) return;
  order_.push_back(hash);
  if (order_.size() <= capacity_) return;
  hashes_.erase(order_.front());
  order_.pop_front();
}

bool KnownCallers::Knows(const RequestHead& head) const {
  const std::optional<std::string> secret = SecretIn(head);
  if (!secret) return false;
  const std::string hash = Sha256Of(*secret);
  const std::lock_guard lock(mutex_);
  return hashes_.contains(hash);
}

}  // namespace parkade
