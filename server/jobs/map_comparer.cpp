#include "server/jobs/map_comparer.h"

#include <sys/wait.h>

#include <chrono>

#include "core/error.h"
#include "server/jobs/last_sentence.h"
#include "server/jobs/worker_process.h"
#include "server/store/temporary_path.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxCallers = 8;  // at a time, because each keeps a connection waiting
constexpr std::chrono::seconds kTimeLimit{300};  // for one comparison
constexpr std::chrono::milliseconds kPatience{100};

/// Counts one up as long as it lives.
class Presence {
 public:
  explicit Presence(std::atomic<int>& count) : count_(count), number_(++count) {}
  ~Presence() { --count_; }
  Presence(const Presence&) = delete;
  Presence& operator=(const Presence&) = delete;
  int number() const { return number_; }

 private:
  std::atomic<int>& count_;
  int number_;
};

}  // namespace

MapComparer::MapComparer(const DataDirectory& directory, CompareCommand command)
    : directory_(directory), command_(std::move(command)) {}

std::optional<fs::path> MapComparer::Compare(const std::string& from_map,
                                             const std::string& to_map) {
  const Presence presence(num_callers_);
  if (presence.number() > kMaxCallers) return std::nullopt;
  const fs::path out = directory_.ComparisonFolder(from_map, to_map);
  const std::lock_guard lock(one_at_a_time_);
  if (!fs::exists(out)) Run(from_map, to_map, out);
  return out;
}

void MapComparer::Run(const std::string& from_map, const std::string& to_map,
                      const fs::path& out) const {
  Require(static_cast<bool>(command_), ErrorCode::kInternal, "the service cannot compare maps");
  // It is removed after the process has ended, which may still write there.
  const TemporaryPath folder(directory_.NewTemporaryPath());
  fs::create_directory(folder.get());
  const fs::path log = folder.get() / "log.txt", products = folder.get() / "products";
  const fs::path from = directory_.MapFolder(from_map), to = directory_.MapFolder(to_map);
  WorkerProcess process(command_(from, to, products), {.folder = folder.get(),
                                                       .log = log,
                                                       .temporary_files = folder.get(),
                                                       .hidden = directory_.root(),
                                                       .visible = {from, to}});
  const auto end = std::chrono::steady_clock::now() + kTimeLimit;
  std::optional<int> status;
  while (!(status = process.Wait(kPatience))) {
    Require(!is_stopping_, ErrorCode::kInternal, "the service stops before the maps are compared");
    Require(std::chrono::steady_clock::now() < end, ErrorCode::kInternal,
            "comparing two maps took too long");
  }
  const std::string sentence = LastSentence(log);
  const bool is_done = WIFEXITED(*status) && WEXITSTATUS(*status) == 0 &&
                       fs::is_directory(fs::symlink_status(products));
  const bool is_refused = WIFEXITED(*status) && WEXITSTATUS(*status) == 1 && !sentence.empty();
  Require(is_done || !is_refused, ErrorCode::kInvalidInput, sentence);
  Require(is_done, ErrorCode::kInternal, "comparing two maps failed: " + sentence);
  fs::rename(products,
             out);  // renamed as a whole: a process that is ended early leaves no comparison
}

}  // namespace parkade
