#include "server/ingest/files/remove_at_signal.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>

#include "core/error.h"
#include "server/ingest/files/temporary_folder.h"

namespace parkade {
namespace {

std::atomic<int> pipe_end = -1;  // what a handler may use: lock-free

/// Tells the thread, where anything may be called: all that is safe inside a handler.
void Tell(int signal) {
  const int saved = errno;
  const auto number = static_cast<char>(signal);
  [[maybe_unused]] const ssize_t ignored = ::write(pipe_end, &number, 1);
  errno = saved;
}

void EndBy(int signal) {
  TemporaryFolder::RemoveAll();
  std::signal(signal, SIG_DFL);
  ::kill(::getpid(), signal);
}

}  // namespace

RemoveAtSignal::RemoveAtSignal() {
  Require(::pipe2(pipe_.data(), O_CLOEXEC) == 0, ErrorCode::kInternal,
          "no file descriptor is left to hear signals with");
  pipe_end = pipe_[1];
  thread_ = std::thread([end = pipe_[0]] {
    char signal = 0;
    while (::read(end, &signal, 1) < 0 && errno == EINTR) {
    }
    if (signal != 0) EndBy(signal);
  });
  struct sigaction action {};
  action.sa_handler = Tell;
  action.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    ::sigaction(kSignals[i], nullptr, &before_[i]);
    if (before_[i].sa_handler == SIG_DFL) ::sigaction(kSignals[i], &action, nullptr);
  }
}

RemoveAtSignal::~RemoveAtSignal() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) ::sigaction(kSignals[i], &before_[i], nullptr);
  Tell(0);
  thread_.join();
  for (const int end : pipe_) ::close(end);
}

}  // namespace parkade
