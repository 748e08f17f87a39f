#include "server/jobs/worker_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string_view>

#include "core/error.h"
#include "server/jobs/network_wall.h"

namespace parkade {
namespace {

constexpr int kNiceness = 10;  // above the service's
const std::string kTemporaryFiles = "TMPDIR=";

/// This process's environment with another line for temporary files; with its own where null.
std::vector<char*> Environment(char* temporary_files) {
  std::vector<char*> lines;
  for (char** line = ::environ; *line != nullptr; ++line)
    if (temporary_files == nullptr || !std::string_view(*line).starts_with(kTemporaryFiles))
      lines.push_back(*line);
  if (temporary_files != nullptr) lines.push_back(temporary_files);
  lines.push_back(nullptr);
  return lines;
}

/// Everything the child needs, prepared before fork: after it, only async-signal-safe calls are
/// allowed, because other threads may have held locks.
struct Launch {
  std::vector<char*> arguments, environment;
  const char* folder = nullptr;
  int log_fd = -1, null_fd = -1, input_fd = -1, failure_fd = -1, cgroup_fd = -1;
  pid_t parent = 0;
  bool says_walls = false;
};

[[noreturn]] void RunChild(const Launch& launch) {
  const auto give_up = [&] {
    const int error = errno;
    [[maybe_unused]] const ssize_t ignored = ::write(launch.failure_fd, &error, sizeof(error));
    ::_exit(127);
  };
  ::setpgid(0, 0);
  if (launch.cgroup_fd >= 0 && ::write(launch.cgroup_fd, "0", 1) != 1) {
    constexpr std::string_view kNote = "the worker cannot join its control group\n";
    [[maybe_unused]] const ssize_t ignored = ::write(launch.log_fd, kNote.data(), kNote.size());
  }
  constexpr std::string_view kAlone = "the worker is shut off from the network\n",
                             kOpen = "the worker keeps the network: the kernel allows no other\n";
  const std::string_view network = LeaveNetwork() == 0 ? kAlone : kOpen;
  if (launch.says_walls) {
    [[maybe_unused]] const ssize_t ignored = ::write(launch.log_fd, network.data(), network.size());
  }
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != launch.parent) ::_exit(127);  // the parent died before the line above
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setpriority(PRIO_PROCESS, 0, ::getpriority(PRIO_PROCESS, 0) + kNiceness);
  if (const int fd = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC); fd >= 0) {
    [[maybe_unused]] const ssize_t ignored = ::write(fd, "800", 3);
  }
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int signal : {SIGPIPE, SIGTERM, SIGINT}) ::signal(signal, SIG_DFL);
  if (::dup2(launch.input_fd, 0) < 0 || ::dup2(launch.log_fd, 1) < 0 ||
      ::dup2(launch.log_fd, 2) < 0)
    give_up();
  if (::chdir(launch.folder) != 0) give_up();
  // Sockets that the HTTP library accepted are not close-on-exec.
  ::close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);
  ::execvpe(launch.arguments[0], launch.arguments.data(), launch.environment.data());
  give_up();
  ::_exit(127);
}

}  // namespace

WorkerProcess::WorkerProcess(const std::vector<std::string>& command, const WorkerPlace& place) {
  Require(!command.empty(), ErrorCode::kInternal, "the worker has no command line");
  Launch launch;
  for (const std::string& argument : command)
    launch.arguments.push_back(const_cast<char*>(argument.c_str()));
  launch.arguments.push_back(nullptr);
  std::string temporary_files = kTemporaryFiles + place.temporary_files.string();
  launch.environment =
      Environment(place.temporary_files.empty() ? nullptr : temporary_files.data());
  launch.folder = place.folder.c_str();
  launch.parent = ::getpid();
  launch.says_walls = place.says_walls;
  launch.log_fd = ::open(place.log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  launch.null_fd = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  launch.input_fd = place.input >= 0 ? place.input : launch.null_fd;
  if (!place.cgroup.empty()) launch.cgroup_fd = ::open(place.cgroup.c_str(), O_WRONLY | O_CLOEXEC);
  std::array<int, 2> failure{-1, -1};
  int error = launch.log_fd < 0 || launch.null_fd < 0 || ::pipe2(failure.data(), O_CLOEXEC) != 0
                  ? errno
                  : 0;
  launch.failure_fd = failure[1];
  if (error == 0) {
    pid_ = ::fork();
    if (pid_ == 0) RunChild(launch);
    if (pid_ < 0) error = errno;
  }
  for (const int fd : {launch.log_fd, launch.null_fd, launch.cgroup_fd, failure[1]})
    if (fd >= 0) ::close(fd);
  // A successful exec closes the pipe; otherwise the pipe tells why there was none.
  if (error == 0 && ::read(failure[0], &error, sizeof(error)) != sizeof(error)) error = 0;
  ::close(failure[0]);
  if (error != 0) {
    if (pid_ > 0) ::waitpid(pid_, nullptr, 0);
    throw Error(ErrorCode::kInternal,
                std::string("the worker cannot be started: ") + std::strerror(error));
  }
  // Called by its number, since glibc 2.36 declares pidfd_open without C linkage.
  pid_fd_ = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));
}

WorkerProcess::~WorkerProcess() {
  if (!status_) {
    Signal(SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  if (pid_fd_ >= 0) ::close(pid_fd_);
}

std::optional<int> WorkerProcess::Wait(std::chrono::milliseconds patience) {
  if (status_) return status_;
  pollfd ended{pid_fd_, POLLIN, 0};
  ::poll(&ended, 1, static_cast<int>(patience.count()));
  siginfo_t end{};
  const int result = ::waitid(P_PID, static_cast<id_t>(pid_), &end, WEXITED | WNOHANG | WNOWAIT);
  if (result != 0 || end.si_pid != pid_) return std::nullopt;
  // Processes that it left behind in its group end too. That comes before waitpid, after which the
  // number may be another's.
  ::kill(-pid_, SIGKILL);
  int status = 0;
  ::waitpid(pid_, &status, 0);
  status_ = status;
  return status_;
}

void WorkerProcess::Signal(int signal) const {
  if (!status_) ::kill(-pid_, signal);
}

std::optional<std::int64_t> ProcessStartTime(pid_t pid) {
  std::ifstream stream("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  if (!std::getline(stream, text)) return std::nullopt;
  // The second field is the program's name in brackets and may hold anything.
  const size_t bracket = text.rfind(')');
  if (bracket == std::string::npos) return std::nullopt;
  std::istringstream fields(text.substr(bracket + 1));
  std::string field;
  for (int number = 3; number <= 22; ++number) fields >> field;
  return fields ? std::optional<std::int64_t>(std::stoll(field)) : std::nullopt;
}

}  // namespace parkade
