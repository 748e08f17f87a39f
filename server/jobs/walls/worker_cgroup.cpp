#include "server/jobs/walls/worker_cgroup.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <thread>

namespace parkade {
namespace {

namespace fs = std::filesystem;

const std::string kPrefix = "parkade-worker-";  // followed by the service's process number

struct CgroupPlace {
  fs::path folder;
  int version = 1;
};

/// This process's own groups that may have a controller. In a container the path that the kernel
/// names may be the host's: the root of what is mounted comes next.
std::vector<CgroupPlace> OwnCgroups(const std::string& controller) {
  std::vector<CgroupPlace> places;
  std::ifstream stream("/proc/self/cgroup");
  for (std::string line; std::getline(stream, line);) {
    const size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const fs::path path = fs::path(line.substr(second + 1)).relative_path();
    if (!controllers.empty() && controllers != controller) continue;
    const int version = controllers.empty() ? 2 : 1;
    const fs::path root = version == 2 ? "/sys/fs/cgroup" : "/sys/fs/cgroup/" + controller;
    for (const fs::path& folder : {root / path, root}) places.push_back({folder, version});
  }
  return places;
}

bool Write(const fs::path& file, const std::string& text) {
  std::ofstream stream(file);
  stream << text;
  stream.close();
  return stream.good();
}

/// The number behind `word` in a file of lines "word number"; 0 where there is none.
std::int64_t NumberIn(const fs::path& file, const std::string& word) {
  std::ifstream stream(file);
  std::string found;
  std::int64_t number = 0;
  while (stream >> found) {
    if (found != word) continue;
    stream >> number;
    break;
  }
  return number;
}

/// The number that is alone in a file; nothing for "max".
std::optional<std::int64_t> OnlyNumberIn(const fs::path& file) {
  std::ifstream stream(file);
  std::int64_t number = 0;
  return stream >> number ? std::optional(number) : std::nullopt;
}

/// The kernel removes only groups without processes.
void RemoveOrphans(const fs::path& parent) {
  std::error_code error;
  for (fs::directory_iterator entry(parent, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename();
    if (!name.starts_with(kPrefix)) continue;
    const int owner = std::atoi(name.c_str() + kPrefix.size());
    if (owner > 0 && ::kill(owner, 0) != 0 && errno == ESRCH) ::rmdir(entry->path().c_str());
  }
}

}  // namespace

WorkerCgroup::WorkerCgroup(std::int64_t memory, int tasks) : memory_bytes_(memory) {
  const std::string bytes = std::to_string(memory), count = std::to_string(tasks);
  memory_ = MakeGroup("memory");
  const bool is_v2 = memory_ && memory_->version == 2;
  if (memory_ &&
      !Write(memory_->folder / (is_v2 ? "memory.max" : "memory.limit_in_bytes"), bytes)) {
    Remove(*memory_);
    memory_.reset();
  }
  // Where swap is counted it does not come on top.
  if (memory_)
    Write(memory_->folder / (is_v2 ? "memory.swap.max" : "memory.memsw.limit_in_bytes"),
          is_v2 ? "0" : bytes);
  limits_tasks_ = memory_ && is_v2 && Write(memory_->folder / "pids.max", count);
  if (memory_ && is_v2) return;  // a process is in one group of version 2
  tasks_ = MakeGroup("pids");
  limits_tasks_ = tasks_ && Write(tasks_->folder / "pids.max", count);
}

/// In the first place where there is the right to.
std::optional<WorkerCgroup::Group> WorkerCgroup::MakeGroup(const std::string& controller) {
  static std::atomic<int> num_made = 0;
  for (const CgroupPlace& place : OwnCgroups(controller)) {
    RemoveOrphans(place.folder);
    const Group group{
        place.folder / (kPrefix + std::to_string(::getpid()) + "-" + std::to_string(++num_made)),
        place.version};
    std::error_code error;
    if (!fs::create_directory(group.folder, error)) continue;
    if (fs::exists(group.folder / (controller == "pids" ? "pids.max"
                                   : group.version == 2 ? "memory.max"
                                                        : "memory.limit_in_bytes")))
      return group;
    Remove(group);
  }
  return std::nullopt;
}

void WorkerCgroup::Remove(const Group& group) {
  constexpr int kTries = 100;
  for (int i = 0; i < kTries && ::rmdir(group.folder.c_str()) != 0 && errno == EBUSY; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

WorkerCgroup::~WorkerCgroup() {
  for (const auto& group : {memory_, tasks_})
    if (group) Remove(*group);
}

std::vector<fs::path> WorkerCgroup::ProcessesFiles() const {
  std::vector<fs::path> files;
  for (const auto& group : {memory_, tasks_})
    if (group) files.push_back(group->folder / "cgroup.procs");
  return files;
}

std::optional<int> WorkerCgroup::memory_version() const {
  return memory_ ? std::optional(memory_->version) : std::nullopt;
}

bool WorkerCgroup::HasKilled() const {
  return memory_ && NumberIn(memory_->folder /
                                 (memory_->version == 2 ? "memory.events" : "memory.oom_control"),
                             "oom_kill") > 0;
}

bool WorkerCgroup::HasReachedLimit() const {
  if (!memory_) return false;
  if (memory_->version == 2) return NumberIn(memory_->folder / "memory.events", "max") > 0;
  // The count of failures is not kept by every kernel.
  constexpr double kNearly = 0.95;
  const std::int64_t peak = OnlyNumberIn(memory_->folder / "memory.max_usage_in_bytes").value_or(0);
  return static_cast<double>(peak) >= kNearly * static_cast<double>(memory_bytes_);
}

std::int64_t DefaultMemoryLimit() {
  std::int64_t bytes = std::int64_t{::sysconf(_SC_PHYS_PAGES)} * ::sysconf(_SC_PAGESIZE);
  for (const CgroupPlace& place : OwnCgroups("memory"))
    if (const auto limit = OnlyNumberIn(
            place.folder / (place.version == 2 ? "memory.max" : "memory.limit_in_bytes")))
      bytes = std::min(bytes, *limit);
  return bytes / 10 * 9;
}

std::int64_t KernelMemoryKills() { return NumberIn("/proc/vmstat", "oom_kill"); }

}  // namespace parkade
