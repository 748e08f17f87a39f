#include "server/jobs/walls/worker_init.h"

#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace parkade {

pid_t ForkAgain(unsigned long flags) {
  return static_cast<pid_t>(::syscall(SYS_clone, flags | SIGCHLD, nullptr, nullptr, nullptr, 0));
}

void WaitAsInit(pid_t worker, int status) {
  ::prctl(PR_SET_NAME, "parkade-init");
  sigset_t all;
  sigfillset(&all);
  ::sigprocmask(SIG_SETMASK, &all, nullptr);
  const auto kept = static_cast<unsigned int>(status);
  if (kept > 0) ::close_range(0, kept - 1, 0);
  ::close_range(kept + 1, ~0U, 0);
  for (;;) {
    int end = 0;
    const pid_t ended = ::waitpid(-1, &end, 0);
    if (ended < 0 && errno != EINTR) ::_exit(127);
    if (ended != worker) continue;
    [[maybe_unused]] const ssize_t ignored = ::write(status, &end, sizeof(end));
    ::_exit(0);
  }
}

}  // namespace parkade
