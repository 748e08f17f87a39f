#include "server/store/uploads/upload_locks.h"

#include <utility>

namespace parkade {

UploadLocks::Hold::Hold(Hold&& other) noexcept
    : locks_(std::exchange(other.locks_, nullptr)), id_(std::move(other.id_)) {}

UploadLocks::Hold::~Hold() {
  if (locks_ != nullptr) locks_->Release(id_);
}

std::optional<UploadLocks::Hold> UploadLocks::Take(const std::string& id,
                                                   std::function<void()> give_up,
                                                   std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  // Called under the lock, so that its holder is still there.
  if (const auto holder = held_.find(id); holder != held_.end()) holder->second();
  if (!released_.wait_for(lock, patience, [&] { return !held_.contains(id); })) return std::nullopt;
  held_[id] = std::move(give_up);
  return std::optional<Hold>(std::in_place, *this, id);
}

void UploadLocks::Release(const std::string& id) {
  {
    const std::lock_guard lock(mutex_);
    held_.erase(id);
  }
  released_.notify_all();
}

}  // namespace parkade
