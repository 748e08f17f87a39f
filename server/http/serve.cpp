#include "server/http/serve.h"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

#include "core/log.h"
#include "server/http/service.h"

namespace parkade {
namespace {

/// Waits for SIGTERM and SIGINT in a thread of its own, as a place where anything
/// may be called. To be made before any other thread, which would take the
/// signals otherwise.
class SignalWaiter {
 public:
  SignalWaiter() {
    sigemptyset(&signals_);
    for (const int signal : {SIGTERM, SIGINT, SIGUSR1}) sigaddset(&signals_, signal);
    pthread_sigmask(SIG_BLOCK, &signals_, &before_);
    std::signal(SIGPIPE, SIG_IGN);
  }
  ~SignalWaiter() {
    if (thread_.joinable()) {
      pthread_kill(thread_.native_handle(), SIGUSR1);  // ends the wait
      thread_.join();
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  SignalWaiter(const SignalWaiter&) = delete;
  SignalWaiter& operator=(const SignalWaiter&) = delete;

  template <typename Action>
  void Start(Action action) {
    thread_ = std::thread([this, action] {
      int signal = 0;
      sigwait(&signals_, &signal);
      if (signal != SIGUSR1) action();
    });
  }

 private:
  sigset_t signals_{}, before_{};
  std::thread thread_;
};

}  // namespace

int Serve(const ServeOptions& options) {
  SignalWaiter signals;
  Service service(options);
  signals.Start([&service, patience = std::chrono::seconds(options.drain_seconds)] {
    LogInfo("stopping");
    service.Stop(patience);
  });
  if (options.allow_public) LogWarning("listening without authentication, as --allow-public says");
  LogInfo("listening on " + service.address());
  service.Run();
  LogInfo("stopped");
  return 0;
}

}  // namespace parkade
