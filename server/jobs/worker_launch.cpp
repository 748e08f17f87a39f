#include "server/jobs/worker_launch.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <string_view>

#include "server/jobs/walls/namespaces.h"
#include "server/jobs/walls/rights.h"
#include "server/jobs/walls/worker_init.h"

namespace parkade {
namespace {

constexpr int kNiceness = 10;  // above the service's

void Send(int fd, int number) {
  [[maybe_unused]] const ssize_t ignored = ::write(fd, &number, sizeof(number));
}

void Say(const WorkerLaunch& launch, std::string_view line) {
  [[maybe_unused]] const ssize_t ignored = ::write(launch.log_fd, line.data(), line.size());
}

[[noreturn]] void GiveUp(const WorkerLaunch& launch) {
  Send(launch.failure_fd, errno);
  ::_exit(127);
}

void BlockSignals(int how) {
  sigset_t all;
  sigfillset(&all);
  ::sigprocmask(how, &all, nullptr);
}

void JoinCgroups(const WorkerLaunch& launch) {
  for (const int fd : launch.cgroup_fds)
    if (::write(fd, "0", 1) != 1) Say(launch, "the worker cannot join its control group\n");
}

void BeModest() {
  ::setpriority(PRIO_PROCESS, 0, ::getpriority(PRIO_PROCESS, 0) + kNiceness);
  if (const int fd = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC); fd >= 0) {
    [[maybe_unused]] const ssize_t ignored = ::write(fd, "800", 3);
    ::close(fd);
  }
}

/// Goes on as a process that stands for the worker and dies with the service's thread: the init of
/// the new namespace where there is one.
void BeChildOfService(const WorkerLaunch& launch, bool has_namespace) {
  ::close(launch.failure_reader_fd);
  const pid_t chosen = has_namespace ? ForkAgain(CLONE_PARENT) : ::getpid();
  if (chosen < 0) GiveUp(launch);
  if (chosen > 0) Send(launch.process_fd, chosen);
  if (has_namespace && chosen > 0) ::_exit(0);
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  pollfd service{launch.failure_fd, 0, 0};  // nobody reads any more: it died before the line above
  if (::poll(&service, 1, 0) == 1 && (service.revents & POLLERR) != 0) ::_exit(127);
}

[[noreturn]] void Execute(const WorkerLaunch& launch) {
  for (const int signal : {SIGPIPE, SIGTERM, SIGINT}) ::signal(signal, SIG_DFL);
  BlockSignals(SIG_UNBLOCK);
  if (::dup2(launch.input_fd, 0) < 0 || ::dup2(launch.log_fd, 1) < 0 ||
      ::dup2(launch.log_fd, 2) < 0 || ::chdir(launch.folder.c_str()) != 0)
    GiveUp(launch);
  // Sockets that the HTTP library accepted are not close-on-exec.
  ::close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);
  ::execvpe(launch.arguments[0], launch.arguments.data(), launch.environment.data());
  GiveUp(launch);
}

}  // namespace

void RunWorker(WorkerLaunch& launch) {
  BlockSignals(SIG_BLOCK);  // the service's handlers are not for the worker
  JoinCgroups(launch);
  BeModest();
  const int left = LeaveOthers();
  const bool has_init = (left & CLONE_NEWPID) != 0;
  BeChildOfService(launch, has_init);
  const std::string_view files = launch.wall.Raise();
  if (launch.says_walls) {
    Say(launch, (left & CLONE_NEWNET) != 0
                    ? "the worker is shut off from the network\n"
                    : "the worker keeps the network, the kernel allows no other\n");
    Say(launch, files);
    Say(launch, has_init ? "the worker sees no other process\n"
                         : "the worker sees other processes, the kernel allows no other\n");
  }
  const pid_t worker = has_init ? ForkAgain(0) : 0;
  if (worker < 0) GiveUp(launch);
  if (worker > 0) WaitAsInit(worker, launch.status_fd);
  SetResourceLimits(launch.limits, (left & CLONE_NEWUSER) != 0 ? 0 : launch.tasks_of_user);
  DropRights();
  Execute(launch);
}

}  // namespace parkade
