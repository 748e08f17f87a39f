#include "server/jobs/slurm/run_command.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/error.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kMaxErrors = 4096;

/// sbatch hands its environment on to jobs, and a service may hold secrets in its own.
std::vector<char*> Environment() {
  constexpr std::array<std::string_view, 8> kBeginnings = {
      "PATH=", "HOME=", "USER=", "LOGNAME=", "LANG=", "TZ=", "SLURM_", "SBATCH_"};
  std::vector<char*> lines;
  for (char** line = ::environ; *line != nullptr; ++line)
    if (std::any_of(kBeginnings.begin(), kBeginnings.end(), [&](std::string_view beginning) {
          return std::string_view(*line).starts_with(beginning);
        }))
      lines.push_back(*line);
  lines.push_back(nullptr);
  return lines;
}

/// Both ends of a pipe, closed with it.
struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    Require(::pipe2(ends.data(), O_CLOEXEC) == 0, ErrorCode::kInternal,
            "no file descriptor is left to run a command with");
    // The end for reading alone: programs do not expect a full output to refuse.
    ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  }
  ~Pipe() {
    for (const int end : ends)
      if (end >= 0) ::close(end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void CloseWritingEnd() { ::close(std::exchange(ends[1], -1)); }
};

/// A program that was started with its output in pipes; killed and waited for with this object.
class Child {
 public:
  Child(const std::vector<std::string>& command, Pipe& output, Pipe& errors) {
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    std::vector<char*> environment = Environment();
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&actions, output.ends[1], 1);
    ::posix_spawn_file_actions_adddup2(&actions, errors.ends[1], 2);
    // Sockets that the HTTP library accepted are not close-on-exec.
    ::posix_spawn_file_actions_addclosefrom_np(&actions, 3);
    posix_spawnattr_t attributes;
    ::posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    ::posix_spawnattr_setsigmask(&attributes, &none);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    const int error = ::posix_spawnp(&pid_, arguments[0], &actions, &attributes, arguments.data(),
                                     environment.data());
    ::posix_spawnattr_destroy(&attributes);
    ::posix_spawn_file_actions_destroy(&actions);
    Require(error == 0, ErrorCode::kInternal,
            "'" + command.front() + "' cannot be started: " + std::strerror(error));
  }
  ~Child() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    Wait();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  int Wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_ = -1;
};

/// Appends what there is, up to `most`, and leaves out the rest. False at the end.
bool Take(int fd, std::string& text, std::size_t most) {
  std::array<char, 65536> piece;
  const ssize_t count = ::read(fd, piece.data(), piece.size());
  if (count < 0) return errno == EAGAIN || errno == EINTR;
  text.append(piece.data(),
              std::min(static_cast<std::size_t>(count), most - std::min(most, text.size())));
  return count > 0;
}

}  // namespace

CommandResult RunCommand(const std::vector<std::string>& command, milliseconds patience,
                         std::size_t max_bytes) {
  Require(!command.empty(), ErrorCode::kInternal, "there is no command");
  Pipe output, errors;
  Child child(command, output, errors);
  output.CloseWritingEnd();
  errors.CloseWritingEnd();
  CommandResult result;
  std::array<pollfd, 2> open{{{output.ends[0], POLLIN, 0}, {errors.ends[0], POLLIN, 0}}};
  const auto end = steady_clock::now() + patience;
  while (open[0].fd >= 0 || open[1].fd >= 0) {
    const auto left = std::chrono::ceil<milliseconds>(end - steady_clock::now()).count();
    Require(left > 0, ErrorCode::kInternal, "'" + command.front() + "' does not answer");
    ::poll(open.data(), open.size(), static_cast<int>(left));
    if (open[0].revents != 0 && !Take(open[0].fd, result.output, max_bytes)) open[0].fd = -1;
    if (open[1].revents != 0 && !Take(open[1].fd, result.errors, kMaxErrors)) open[1].fd = -1;
    Require(result.output.size() < max_bytes, ErrorCode::kInternal,
            "'" + command.front() + "' says too much");
  }
  result.status = child.Wait();
  return result;
}

}  // namespace parkade
