#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace parkade {

/// Tells systemd how the service is (sd_notify(3)): ready from the construction on, stopping at the
/// end, and, where it asks for that (WATCHDOG_USEC), that the service still answers: it asks itself
/// for /healthz over HTTP first. Does nothing under another supervisor.
class Supervisor {
 public:
  /// `host` and `port` are what the service listens on.
  Supervisor(std::string host, int port);
  ~Supervisor();
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

 private:
  void Watch();
  bool IsAnswering() const;

  const std::string host_;
  const int port_;
  std::mutex mutex_;
  std::condition_variable stopping_;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace parkade
