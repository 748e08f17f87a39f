#include "server/http/service/serve.h"

#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <thread>

#include "core/error.h"
#include "core/log.h"
#include "server/http/listen_address.h"
#include "server/http/service/service.h"
#include "server/http/service/supervisor.h"
#include "server/http/trace/request_trace.h"

namespace parkade {
namespace {

constexpr int kTryAgain = 75;  // EX_TEMPFAIL of sysexits.h
constexpr std::chrono::seconds kPatienceAfterFailure{2};

std::atomic<int> wake_fd = -1;  // what a handler may use: lock-free

/// Adds to the event counter: all that is safe inside a signal handler.
void Wake(int) {
  const int saved = errno;
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t ignored = ::write(wake_fd, &one, sizeof(one));
  errno = saved;
}

/// Hears SIGTERM and SIGINT, and acts in a thread of its own, where anything may be called.
/// Our threads leave the signals to that one: a handler would disturb what they do. But
/// libraries start threads before main (OpenBLAS does) that leave signals open, so that
/// whichever thread the kernel picks there is a handler, and not the default: the end.
/// Make it before any other thread of ours.
class SignalWaiter {
 public:
  SignalWaiter() {
    wake_fd = event_fd_ = ::eventfd(0, EFD_CLOEXEC);
    Require(event_fd_ >= 0, ErrorCode::kInternal,
            "no file descriptor is left to hear signals with");
    struct sigaction action {};
    action.sa_handler = Wake;
    action.sa_flags = SA_RESTART;
    sigfillset(&action.sa_mask);
    ::sigaction(SIGTERM, &action, &terminate_before_);
    ::sigaction(SIGINT, &action, &interrupt_before_);
    std::signal(SIGPIPE, SIG_IGN);
    sigemptyset(&signals_);
    for (const int signal : {SIGTERM, SIGINT}) sigaddset(&signals_, signal);
    ::pthread_sigmask(SIG_BLOCK, &signals_, &mask_before_);
  }
  ~SignalWaiter() {
    ::sigaction(SIGTERM, &terminate_before_, nullptr);
    ::sigaction(SIGINT, &interrupt_before_, nullptr);
    is_ending_ = true;
    Wake(0);
    if (thread_.joinable()) thread_.join();
    wake_fd = -1;
    ::close(event_fd_);
    ::pthread_sigmask(SIG_SETMASK, &mask_before_, nullptr);
  }
  SignalWaiter(const SignalWaiter&) = delete;
  SignalWaiter& operator=(const SignalWaiter&) = delete;

  /// A signal that came before counts too.
  template <typename Action>
  void Start(Action action) {
    thread_ = std::thread([this, action] {
      ::pthread_sigmask(SIG_UNBLOCK, &signals_, nullptr);
      std::uint64_t count = 0;
      while (::read(event_fd_, &count, sizeof(count)) < 0 && errno == EINTR) {
      }
      if (!is_ending_) action();
    });
  }

 private:
  int event_fd_ = -1;
  sigset_t signals_{}, mask_before_{};
  std::atomic<bool> is_ending_ = false;
  struct sigaction terminate_before_ {
  }, interrupt_before_{};
  std::thread thread_;
};

/// Slow clients hold file descriptors: a service takes more than the 1024 that systems give to
/// programs that have not asked.
void AskForFileDescriptors() {
  constexpr rlim_t kEnough = 16384;
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) != 0 || files.rlim_cur >= kEnough) return;
  files.rlim_cur = std::min(kEnough, files.rlim_max);
  ::setrlimit(RLIMIT_NOFILE, &files);
}

}  // namespace

int Serve(const ServeOptions& options) {
  SetLogLineFormat(options.log_format);
  SetAccessLog(options.access_log.value_or(options.log_format == LogLineFormat::kJson));
  SignalWaiter signals;
  AskForFileDescriptors();
  Service service(options);
  service.OnDiskFailure([] { Wake(0); });
  signals.Start([&service, patience = std::chrono::seconds(options.drain_seconds)] {
    LogInfo("stopping");
    service.Stop(service.has_disk_failed() ? std::min(patience, kPatienceAfterFailure) : patience);
  });
  LogInfo("listening on " + service.address());
  {
    const Supervisor supervisor(ParseListenAddress(options.listen).host, service.port());
    service.Run();
  }
  LogInfo("stopped");
  return service.has_disk_failed() ? kTryAgain : 0;
}

}  // namespace parkade
