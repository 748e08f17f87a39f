#include "server/http/request_pool.h"

#include <algorithm>
#include <system_error>
#include <tuple>

#include "core/log.h"

namespace parkade {

RequestPool::RequestPool(const PoolSize& size, const PoolHooks& hooks, RouteClassMetrics& metrics)
    : size_(size), hooks_(hooks), metrics_(metrics) {}

bool RequestPool::Submit(std::unique_ptr<HttpConnection>& connection) {
  const std::lock_guard lock(mutex_);
  const size_t num_inside = num_busy_ + num_waiting();
  if (is_stopping_ || num_inside >= size_.num_threads + size_.num_places) return false;
  const bool is_known = connection->is_known();
  const size_t num_for_strangers = size_.num_threads - size_.num_threads_for_known +
                                   size_.num_places - size_.num_places_for_known;
  if (!is_known && num_busy_strangers_ + strangers_.size() >= num_for_strangers) return false;
  if (num_inside >= threads_.size() && threads_.size() < size_.num_threads) {
    try {
      threads_.emplace_back([this] { Work(); });
    } catch (const std::system_error& error) {  // the machine has no more: those there are must do
      LogWarning(std::string("no thread: ") + error.what());
      if (threads_.empty()) return false;
    }
  }
  (is_known ? known_ : strangers_).push_back(std::move(connection));
  ++metrics_.waiting;
  changed_.notify_one();
  return true;
}

bool RequestPool::HasThreadForStranger() const {
  return num_busy_strangers_ < size_.num_threads - size_.num_threads_for_known;
}

RequestPool::Queue* RequestPool::NextQueue() {
  if (!known_.empty()) return &known_;
  return !strangers_.empty() && HasThreadForStranger() ? &strangers_ : nullptr;
}

void RequestPool::Work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    Queue* queue = nullptr;
    changed_.wait(lock, [&] {
      queue = NextQueue();
      return queue != nullptr || (is_stopping_ && num_waiting() == 0);
    });
    if (queue == nullptr) return;
    const size_t num_strangers = queue == &strangers_ ? 1 : 0;
    std::unique_ptr<HttpConnection> connection = std::move(queue->front());
    queue->pop_front();
    answered_.push_back(connection.get());
    ++num_busy_;
    num_busy_strangers_ += num_strangers;
    --metrics_.waiting;
    ++metrics_.busy;
    lock.unlock();
    try {
      hooks_.answer(*connection);
    } catch (const std::exception& error) {
      LogError(std::string("connection exception=") + error.what());
    }
    lock.lock();
    std::erase(answered_, connection.get());
    lock.unlock();
    hooks_.leave(std::move(connection));
    lock.lock();
    --num_busy_;
    num_busy_strangers_ -= num_strangers;
    --metrics_.busy;
    // A stranger that waits may have this thread; at the end, all look up.
    if (is_stopping_) changed_.notify_all();
  }
}

void RequestPool::Relieve(HttpConnection::Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const size_t num_held_up = num_busy_ >= size_.num_threads ? num_waiting()
                             : HasThreadForStranger()       ? 0
                                                            : strangers_.size();
  if (num_held_up == 0) return;
  std::vector<std::tuple<bool, double, HttpConnection*>> slow;
  size_t num_leaving = 0;
  for (HttpConnection* connection : answered_) {
    const auto pace = connection->pace().PaceOver(PaceMeter::kGraceUnderPressure, now);
    if (connection->is_cut_off()) {
      ++num_leaving;
    } else if (pace && *pace < PaceMeter::kLeastPace) {
      slow.emplace_back(connection->is_known(), *pace, connection);
    }
  }
  std::sort(slow.begin(), slow.end());
  const size_t num_wanted = num_held_up - std::min(num_held_up, num_leaving);
  for (size_t i = 0; i < std::min(slow.size(), num_wanted); ++i) std::get<2>(slow[i])->CutOff();
}

bool RequestPool::IsIdle() const {
  const std::lock_guard lock(mutex_);
  return num_busy_ == 0 && num_waiting() == 0;
}

void RequestPool::Join() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

}  // namespace parkade
