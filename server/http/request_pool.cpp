#include "server/http/request_pool.h"

#include <algorithm>
#include <system_error>

#include "core/log.h"

namespace parkade {

RequestPool::RequestPool(size_t max_threads, size_t max_waiting, const PoolHooks& hooks,
                         RouteClassMetrics& metrics)
    : max_threads_(max_threads), max_waiting_(max_waiting), hooks_(hooks), metrics_(metrics) {}

bool RequestPool::Submit(std::unique_ptr<HttpConnection>& connection) {
  const std::lock_guard lock(mutex_);
  const size_t num_inside = num_busy_ + waiting_.size();
  if (is_stopping_ || num_inside >= max_threads_ + max_waiting_) return false;
  if (num_inside >= threads_.size() && threads_.size() < max_threads_) {
    try {
      threads_.emplace_back([this] { Work(); });
    } catch (const std::system_error& error) {  // the machine has no more: those there are must do
      LogWarning(std::string("no thread: ") + error.what());
      if (threads_.empty()) return false;
    }
  }
  waiting_.push_back(std::move(connection));
  ++metrics_.waiting;
  changed_.notify_one();
  return true;
}

void RequestPool::Work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return is_stopping_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    std::unique_ptr<HttpConnection> connection = std::move(waiting_.front());
    waiting_.pop_front();
    answered_.push_back(connection.get());
    ++num_busy_;
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
    --metrics_.busy;
  }
}

void RequestPool::Relieve(HttpConnection::Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty() || num_busy_ < max_threads_) return;
  std::vector<std::pair<double, HttpConnection*>> slow;
  size_t num_leaving = 0;
  for (HttpConnection* connection : answered_) {
    const auto pace = connection->pace().PaceOver(PaceMeter::kGraceUnderPressure, now);
    if (connection->is_cut_off()) {
      ++num_leaving;
    } else if (pace && *pace < PaceMeter::kLeastPace) {
      slow.emplace_back(*pace, connection);
    }
  }
  std::sort(slow.begin(), slow.end());
  const size_t num_wanted = waiting_.size() - std::min(waiting_.size(), num_leaving);
  for (size_t i = 0; i < std::min(slow.size(), num_wanted); ++i) slow[i].second->CutOff();
}

bool RequestPool::IsIdle() const {
  const std::lock_guard lock(mutex_);
  return num_busy_ == 0 && waiting_.empty();
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
