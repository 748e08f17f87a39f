#include "server/jobs/memory_cgroup.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <optional>
#include <thread>
#include <vector>

namespace parkade {
namespace {

namespace fs = std::filesystem;

const std::string kPrefix = "parkade-worker-";  // followed by the service's process number

struct CgroupPlace {
  fs::path folder;
  int version = 1;
};

/// This process's own groups that may have a memory controller. In a container the path that the
/// kernel names may be the host's: the root of what is mounted comes next.
std::vector<CgroupPlace> OwnCgroups() {
  std::vector<CgroupPlace> places;
  std::ifstream stream("/proc/self/cgroup");
  for (std::string line; std::getline(stream, line);) {
    const size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const fs::path path = fs::path(line.substr(second + 1)).relative_path();
    if (!controllers.empty() && controllers != "memory") continue;
    const int version = controllers.empty() ? 2 : 1;
    const fs::path root = version == 2 ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
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

MemoryCgroup::MemoryCgroup(fs::path folder, int version, std::int64_t bytes)
    : folder_(std::move(folder)), version_(version), bytes_(bytes) {}

std::unique_ptr<MemoryCgroup> MemoryCgroup::Make(std::int64_t bytes) {
  static std::atomic<int> num_made = 0;
  for (const CgroupPlace& place : OwnCgroups()) {
    RemoveOrphans(place.folder);
    const fs::path folder =
        place.folder / (kPrefix + std::to_string(::getpid()) + "-" + std::to_string(++num_made));
    std::error_code error;
    if (!fs::create_directory(folder, error)) continue;
    std::unique_ptr<MemoryCgroup> made(new MemoryCgroup(folder, place.version, bytes));
    const std::string limit = std::to_string(bytes);
    const bool is_v2 = place.version == 2;
    if (!Write(folder / (is_v2 ? "memory.max" : "memory.limit_in_bytes"), limit)) continue;
    // Where swap is counted it does not come on top.
    Write(folder / (is_v2 ? "memory.swap.max" : "memory.memsw.limit_in_bytes"),
          is_v2 ? "0" : limit);
    return made;
  }
  return nullptr;
}

MemoryCgroup::~MemoryCgroup() {
  constexpr int kTries = 100;
  for (int i = 0; i < kTries && ::rmdir(folder_.c_str()) != 0 && errno == EBUSY; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

bool MemoryCgroup::HasKilled() const {
  return NumberIn(folder_ / (version_ == 2 ? "memory.events" : "memory.oom_control"), "oom_kill") >
         0;
}

bool MemoryCgroup::HasReachedLimit() const {
  if (version_ == 2) return NumberIn(folder_ / "memory.events", "max") > 0;
  // The count of failures is not kept by every kernel.
  constexpr double kNearly = 0.95;
  const std::int64_t peak = OnlyNumberIn(folder_ / "memory.max_usage_in_bytes").value_or(0);
  return static_cast<double>(peak) >= kNearly * static_cast<double>(bytes_);
}

std::int64_t DefaultMemoryLimit() {
  std::int64_t bytes = std::int64_t{::sysconf(_SC_PHYS_PAGES)} * ::sysconf(_SC_PAGESIZE);
  for (const CgroupPlace& place : OwnCgroups())
    if (const auto limit = OnlyNumberIn(
            place.folder / (place.version == 2 ? "memory.max" : "memory.limit_in_bytes")))
      bytes = std::min(bytes, *limit);
  return bytes / 10 * 9;
}

std::int64_t KernelMemoryKills() { return NumberIn("/proc/vmstat", "oom_kill"); }

}  // namespace parkade
