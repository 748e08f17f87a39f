#include "server/store/care/scrubber.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <tuple>
#include <unordered_map>

#include "core/log.h"
#include "server/store/tables/check_table.h"
#include "server/store/tables/names.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kLookInterval = 10min;  // for files that became due
constexpr auto kPause = 20ms;  // after every MiB: reads at most 50 MiB/s

/// Lets every other thread and every other reader of the disk go first.
void GiveWay() {
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), 19);
  constexpr int kWhoProcess = 1, kIdleClass = 3 << 13;
  ::syscall(SYS_ioprio_set, kWhoProcess, 0, kIdleClass);
}

std::vector<StoredFile> FilesOf(Store& store) {
  return store.database.Read([](Connection& connection) { return StoredFiles(connection); });
}

/// Those that were not read for `interval`, whichever was read longest ago first.
std::vector<StoredFile> DueFiles(Store& store, std::chrono::milliseconds interval) {
  std::unordered_map<std::string, std::string> checked_at;
  for (auto& [path, time] :
       store.database.Read([](Connection& connection) { return FileCheckTimes(connection); }))
    checked_at[path] = time;
  const std::string due = UtcText(std::chrono::system_clock::now() - interval);
  // Times are texts that sort; a file never read comes first. They are looked up once, since there
  // are tens of thousands.
  std::vector<std::pair<std::string, StoredFile>> found;
  for (StoredFile& file : FilesOf(store)) {
    std::string time = checked_at[file.path];
    if (time <= due) found.emplace_back(std::move(time), std::move(file));
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second.path) < std::tie(b.first, b.second.path);
  });
  std::vector<StoredFile> files;
  for (auto& [time, file] : found) files.push_back(std::move(file));
  return files;
}

}  // namespace

Scrubber::Scrubber(Store& store, std::chrono::milliseconds interval)
    : store_(store), thread_([this, interval] { Work(interval); }) {}

Scrubber::~Scrubber() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  stopping_.notify_all();
  thread_.join();
}

/// False when the scrubber is to end.
bool Scrubber::Rest(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  return !stopping_.wait_for(lock, time, [this] { return is_stopping_; });
}

void Scrubber::Work(std::chrono::milliseconds interval) {
  GiveWay();
  try {
    LookAtAll();
    while (interval > 0ms) {
      ReadDue(interval);
      if (!Rest(std::min(interval, kLookInterval))) return;
    }
  } catch (const std::exception& error) {
    LogError(std::string("stored files are not looked after any more error=") + error.what());
  }
}

void Scrubber::LookAtAll() {
  for (const StoredFile& file : FilesOf(store_)) {
    const std::optional<std::string> damage = LookAtStoredFile(store_.directory.root(), file);
    if (damage) RecordFileCheck(store_, file.path, damage);
    if (!Rest(0ms)) return;
  }
}

void Scrubber::ReadDue(std::chrono::milliseconds interval) {
  for (const StoredFile& file : DueFiles(store_, interval)) {
    bool is_read = true;
    const std::optional<std::string> damage =
        CheckStoredFile(store_.directory.root(), file, [&] { return is_read = Rest(kPause); });
    if (!is_read) return;
    RecordFileCheck(store_, file.path, damage);
  }
}

}  // namespace parkade
