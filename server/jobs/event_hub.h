#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

namespace parkade {

/// Something that listeners may want to look at again.
struct Event {
  std::int64_t id = 0;  ///< increases by one
  std::string kind;     ///< "job", "drive", "map", "review" or "comment"
  /// Id of the job or drive; "<site>/<version>" of a map or review, with "/<id>" of a comment.
  std::string subject;
};

/// The last events, for any number of listeners that ask for what came after
/// the last one they saw. Thread-safe.
class EventHub {
 public:
  EventHub();

  void Publish(const std::string& kind, const std::string& subject);

  struct News {
    std::vector<Event> events;  ///< in order
    bool has_gap = false;       ///< events between `last_seen` and these are forgotten
  };

  /// What came after event `last_seen`; waits for it at most `patience`.
  News WaitFor(std::int64_t last_seen, std::chrono::milliseconds patience);

  /// Id of the latest event. Ids of an earlier process are smaller or unknown.
  std::int64_t last_id() const;

  /// Wakes all listeners and lets no one wait again.
  void Close();

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Event> events_;
  std::int64_t first_id_ = 0;  ///< of the first event of this process
  std::int64_t next_id_ = 0;
  bool is_closed_ = false;
};

}  // namespace parkade
