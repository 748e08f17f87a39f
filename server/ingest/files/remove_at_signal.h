#pragma once

#include <array>
#include <csignal>
#include <thread>

namespace parkade {

/// While it lives, SIGTERM, SIGINT and SIGHUP delete the process's TemporaryFolders before they end
/// it as they do otherwise. Signals that are ignored stay so. One at a time.
class RemoveAtSignal {
 public:
  RemoveAtSignal();
  ~RemoveAtSignal();
  RemoveAtSignal(const RemoveAtSignal&) = delete;
  RemoveAtSignal& operator=(const RemoveAtSignal&) = delete;

 private:
  static constexpr std::array kSignals = {SIGTERM, SIGINT, SIGHUP};

  std::array<int, 2> pipe_{-1, -1};
  std::array<struct sigaction, kSignals.size()> before_{};
  std::thread thread_;
};

}  // namespace parkade
