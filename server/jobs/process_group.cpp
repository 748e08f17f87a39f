#include "server/jobs/process_group.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>

namespace parkade {
namespace {

namespace fs = std::filesystem;

struct ProcessStat {
  char state = '?';
  pid_t group = -1;
  std::int64_t ticks = 0;  ///< of processor time
  int threads = 0;
};

/// False for a process that is gone.
bool ReadStat(const fs::path& folder, ProcessStat& stat) {
  std::ifstream stream(folder / "stat");
  std::string text;
  if (!std::getline(stream, text)) return false;
  // The second field is the program's name in brackets and may hold anything.
  const size_t bracket = text.rfind(')');
  if (bracket == std::string::npos) return false;
  std::istringstream fields(text.substr(bracket + 1));
  std::int64_t parent = 0, skipped = 0;
  fields >> stat.state >> parent >> stat.group;
  for (int number = 6; number <= 13; ++number) fields >> skipped;
  for (int number = 14; number <= 17; ++number) {  // of itself and of children it waited for
    std::int64_t ticks = 0;
    fields >> ticks;
    stat.ticks += ticks;
  }
  fields >> skipped >> skipped >> stat.threads;
  return static_cast<bool>(fields);
}

/// Sum of the numbers behind two of the words in a file of lines "Word: number".
std::int64_t SumOf(const fs::path& file, const std::string& first, const std::string& second) {
  std::ifstream stream(file);
  std::int64_t sum = 0;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string word;
    std::int64_t number = 0;
    if (words >> word >> number && (word == first || word == second)) sum += number;
  }
  return sum;
}

bool HasBusyThread(const fs::path& process) {
  std::error_code gone;
  for (fs::directory_iterator entry(process / "task", gone), end; !gone && entry != end;
       entry.increment(gone)) {
    ProcessStat thread;
    if (ReadStat(entry->path(), thread) && (thread.state == 'R' || thread.state == 'D'))
      return true;
  }
  return false;
}

/// Calls `use` with the folder of each process in /proc.
template <typename Use>
void ForEachProcess(const Use& use) {
  std::error_code error;
  for (fs::directory_iterator entry("/proc", error), end; !error && entry != end;
       entry.increment(error)) {
    const char first = entry->path().filename().native().front();
    if (first >= '0' && first <= '9') use(entry->path());
  }
}

/// The number of a process's namespace; 0 where it is gone, or not ours to look at.
ino_t NamespaceOf(const fs::path& process) {
  struct stat file {};
  return ::stat((process / "ns/pid").c_str(), &file) == 0 ? file.st_ino : 0;
}

}  // namespace

GroupUsage ReadWorkerUsage(pid_t leader) {
  GroupUsage usage;
  const fs::path leaders_folder = fs::path("/proc") / std::to_string(leader);
  const ino_t space = NamespaceOf(leaders_folder);
  const bool is_init = space != 0 && space != NamespaceOf("/proc/self");
  ForEachProcess([&](const fs::path& process) {
    ProcessStat stat;
    if ((is_init && process == leaders_folder) || !ReadStat(process, stat)) return;
    if (stat.group != leader && !(is_init && NamespaceOf(process) == space)) return;
    usage.processor_seconds +=
        static_cast<double>(stat.ticks) / static_cast<double>(::sysconf(_SC_CLK_TCK));
    usage.memory_bytes += 1024 * SumOf(process / "status", "RssAnon:", "RssShmem:");
    usage.disk_bytes += SumOf(process / "io", "read_bytes:", "write_bytes:");
    usage.is_busy |= HasBusyThread(process);
    usage.tasks += stat.threads;
  });
  return usage;
}

int CountTasksOf(uid_t user) {
  int count = 0;
  ForEachProcess([&](const fs::path& process) {
    struct stat file {};
    ProcessStat stat;
    if (::stat(process.c_str(), &file) == 0 && file.st_uid == user && ReadStat(process, stat))
      count += stat.threads;
  });
  return count;
}

}  // namespace parkade
