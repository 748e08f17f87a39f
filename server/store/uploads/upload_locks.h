#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace parkade {

/// One request at a time works on an upload, and the latest one is right: a client whose link broke
/// comes back while the old request still waits for bytes that never come. Thread-safe.
class UploadLocks {
 public:
  /// Holds an upload as long as it lives.
  class Hold {
   public:
    Hold(UploadLocks& locks, std::string id) : locks_(&locks), id_(std::move(id)) {}
    ~Hold();
    Hold(Hold&& other) noexcept;
    Hold& operator=(Hold&&) = delete;

   private:
    UploadLocks* locks_;
    std::string id_;
  };

  /// Asks whoever holds the upload to give it up, and takes it; nothing where that does not happen
  /// within `patience`. `give_up` is called, from another thread, when it is this holder's turn to
  /// do so.
  std::optional<Hold> Take(const std::string& id, std::function<void()> give_up,
                           std::chrono::milliseconds patience);

 private:
  void Release(const std::string& id);

  std::mutex mutex_;
  std::condition_variable released_;
  std::map<std::string, std::function<void()>> held_;
};

}  // namespace parkade
