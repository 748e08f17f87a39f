#include "server/jobs/worker_process.h"

#include <fcntl.h>
#include <poll.h>
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
#include <system_error>
#include <utility>

#include "core/error.h"
#include "server/jobs/process_group.h"
#include "server/jobs/worker_launch.h"
#include "server/store/disk/file_handle.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

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

std::vector<char*> Arguments(const std::vector<std::string>& command) {
  std::vector<char*> words;
  words.reserve(command.size() + 1);
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  return words;
}

FileRules RulesOf(const WorkerPlace& place) {
  FileRules rules{.writable = place.writable, .hidden = place.hidden, .visible = place.visible};
  rules.writable.push_back(fs::absolute(place.folder));
  return rules;
}

std::int64_t FreeBytes(const fs::path& folder) {
  std::error_code unknown;
  const fs::space_info space = fs::space(folder, unknown);
  return unknown ? 0 : static_cast<std::int64_t>(space.available);
}

[[noreturn]] void ThrowNotStarted(int error) {
  throw Error(ErrorCode::kInternal,
              std::string("the worker cannot be started: ") + std::strerror(error));
}

/// A descriptor that the kernel gave out, or else the reason that it gave none.
FileHandle Opened(int fd) {
  if (fd < 0) ThrowNotStarted(errno);
  return FileHandle(fd);
}

struct Pipe {
  FileHandle reader, writer;

  static Pipe Make() {
    std::array<int, 2> ends{-1, -1};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) ThrowNotStarted(errno);
    return {FileHandle(ends[0]), FileHandle(ends[1])};
  }
};

void SayLimits(int log, const WorkerLimits& limits, const WorkerCgroup& cgroup) {
  const std::optional<int> version = cgroup.memory_version();
  const std::string line =
      "the service limits memory to " + std::to_string(limits.memory_bytes >> 20) + " MiB by " +
      (version ? "a control group (version " + std::to_string(*version) + ")"
               : "looking at it several times a second: no control group can be made") +
      "\nthe service limits processes with their threads to " + std::to_string(limits.tasks) +
      (cgroup.limits_tasks() ? " by a control group\n" : "\n");
  [[maybe_unused]] const ssize_t ignored = ::write(log, line.data(), line.size());
}

std::optional<int> ReadNumber(int fd) {
  int number = 0;
  ssize_t count = 0;
  do count = ::read(fd, &number, sizeof(number));
  while (count < 0 && errno == EINTR);
  return count == sizeof(number) ? std::optional(number) : std::nullopt;
}

}  // namespace

WorkerProcess::WorkerProcess(const std::vector<std::string>& command, const WorkerPlace& place)
    : limits_(Completed(place.limits, FreeBytes(place.folder))),
      cgroup_(std::make_unique<WorkerCgroup>(limits_.memory_bytes, limits_.tasks + kSpareTasks)) {
  Require(!command.empty(), ErrorCode::kInternal, "the worker has no command line");
  std::string temporary_files = kTemporaryFiles + place.temporary_files.string();
  const FileHandle log =
      Opened(::open(place.log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644));
  const FileHandle null = Opened(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  std::vector<FileHandle> cgroups;
  Pipe process = Pipe::Make(), status = Pipe::Make(), failure = Pipe::Make();
  WorkerLaunch launch{
      .arguments = Arguments(command),
      .environment = Environment(place.temporary_files.empty() ? nullptr : temporary_files.data()),
      .folder = fs::absolute(place.folder),
      .wall = FileWall(RulesOf(place)),
      .limits = limits_,
      .tasks_of_user = CountTasksOf(::getuid()),
      .cgroup_fds = {},
      .log_fd = log.fd(),
      .input_fd = place.input >= 0 ? place.input : null.fd(),
      .says_walls = place.says_walls,
      .process_fd = process.writer.fd(),
      .status_fd = status.writer.fd(),
      .failure_fd = failure.writer.fd(),
      .failure_reader_fd = failure.reader.fd()};
  for (const fs::path& file : cgroup_->ProcessesFiles())
    launch.cgroup_fds.push_back(
        cgroups.emplace_back(Opened(::open(file.c_str(), O_WRONLY | O_CLOEXEC))).fd());
  if (place.says_walls) SayLimits(log.fd(), limits_, *cgroup_);
  const pid_t child = ::fork();
  if (child == 0) RunWorker(launch);
  if (child < 0) ThrowNotStarted(errno);
  for (Pipe* pipe : {&process, &status, &failure}) pipe->writer.Close();
  pid_ = ReadNumber(process.reader.fd()).value_or(child);
  if (pid_ != child) ::waitpid(child, nullptr, 0);
  // A successful exec closes the pipe; otherwise the pipe tells why there was none.
  if (const std::optional<int> error = ReadNumber(failure.reader.fd())) {
    ::waitpid(pid_, nullptr, 0);
    ThrowNotStarted(*error);
  }
  status_fd_ = status.reader.Release();
  ::fcntl(status_fd_, F_SETFL, O_NONBLOCK);
  // Called by its number, since glibc 2.36 declares pidfd_open without C linkage.
  pid_fd_ = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));
}

WorkerProcess::~WorkerProcess() {
  if (!status_) {
    Signal(SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  for (const int fd : {pid_fd_, status_fd_})
    if (fd >= 0) ::close(fd);
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
  status_ = ReadNumber(status_fd_).value_or(status);
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
