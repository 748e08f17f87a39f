#include "server/jobs/event_hub.h"

namespace parkade {
namespace {

constexpr size_t kMaxEvents = 4096;

}  // namespace

// Starting from the clock keeps ids of an earlier process from being taken for ours.
EventHub::EventHub() {
  using std::chrono::duration_cast;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  first_id_ = next_id_ = duration_cast<std::chrono::milliseconds>(now).count() * 1000;
}

void EventHub::Publish(const std::string& kind, const std::string& subject) {
  const std::lock_guard lock(mutex_);
  events_.push_back({next_id_++, kind, subject});
  if (events_.size() > kMaxEvents) events_.pop_front();
  changed_.notify_all();
}

EventHub::News EventHub::WaitFor(std::int64_t last_seen, std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, patience, [&] { return is_closed_ || last_seen != next_id_ - 1; });
  News news;
  const std::int64_t oldest = events_.empty() ? next_id_ : events_.front().id;
  const bool is_known = last_seen >= std::max(oldest, first_id_) - 1 && last_seen < next_id_;
  news.has_gap = !is_known;
  for (const Event& event : events_)
    if (!is_known || event.id > last_seen) news.events.push_back(event);
  return news;
}

std::int64_t EventHub::last_id() const {
  const std::lock_guard lock(mutex_);
  return next_id_ - 1;
}

void EventHub::Close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  changed_.notify_all();
}

}  // namespace parkade
