#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "server/jobs/pictures/picture_cache.h"
#include "server/jobs/pictures/picture_times.h"
#include "server/jobs/pictures/picture_worker.h"
#include "server/store/data_directory.h"

namespace parkade {

/// The log that pictures are of.
struct PictureLog {
  std::string drive;  ///< id
  std::filesystem::path file;
  std::optional<std::string> rig;  ///< id; nothing: it came with the log

  /// Where its files lie in the cache.
  std::string Folder() const { return drive + "/" + rig.value_or("log"); }
};

/// A picture as it is handed out.
struct ServedPicture {
  Timestamp time;
  int width = 0, height = 0;            ///< [px]
  int full_width = 0, full_height = 0;  ///< [px] as recorded
  std::string jpeg;
};

struct PictureOptions {
  PictureCommand command;                 ///< none: nobody reads pictures
  PictureCacheLimits cache;               ///< of what is kept of them
  std::chrono::seconds answer_limit{30};  ///< [s] after which a process that reads one is ended
};

/// Hands out pictures of logs, and what goes with them. Logs are opened by processes of their own,
/// two at a time, each kept for a while for the next picture of the same log; what was read is kept
/// in the data directory. Thread-safe.
class PictureDesk {
 public:
  /// Whether the one who asks still waits; asked now and then.
  using IsWanted = std::function<bool()>;

  /// Borrows the directory.
  PictureDesk(const DataDirectory& directory, PictureOptions options,
              const std::function<bool(const std::string& drive)>& is_drive);
  ~PictureDesk();
  PictureDesk(const PictureDesk&) = delete;
  PictureDesk& operator=(const PictureDesk&) = delete;

  // All three throw Error{kInvalidInput} with one sentence where the log cannot be read,
  // Error{kConflict} where too many wait already, it takes longer than half a minute (what was
  // begun goes on), or nobody waits any more.

  /// When the images of all cameras were taken. Reads the log once, the first time.
  std::shared_ptr<const PictureTimes> TimesOf(const PictureLog& log, const IsWanted& is_wanted);

  /// The image of a camera (by its number in PictureTimes) at exactly `time`, at most `width` [px]
  /// wide.
  ServedPicture Read(const PictureLog& log, size_t camera, Timestamp time, int width,
                     const IsWanted& is_wanted);

  /// The images that show a point, as PictureCommand has them, for a drive of a published map.
  nlohmann::json FindViews(const PictureLog& log, const nlohmann::json& request,
                           const IsWanted& is_wanted);

  /// Ends the processes. Final.
  void Stop();

  const PictureCache& cache() const { return cache_; }

 private:
  struct Task {
    PictureLog log;
    nlohmann::json request;  ///< null: nothing but the index
    std::string makes;       ///< name of the file in the cache; empty: none
    std::promise<nlohmann::json> answer;
    std::atomic<bool> is_wanted = true;
  };
  /// The log that a thread has open.
  struct Bench {
    std::string folder;
    std::unique_ptr<PictureWorker> worker;
  };

  nlohmann::json Do(const PictureLog& log, nlohmann::json request, const std::string& makes,
                    const IsWanted& is_wanted);
  void Work(size_t thread);
  std::shared_ptr<Task> Next(size_t thread);
  std::shared_ptr<Task> TakeTask(size_t thread);
  void Perform(Task& task, Bench& bench);
  void Open(const PictureLog& log, Bench& bench);

  const DataDirectory& directory_;
  const PictureOptions options_;
  PictureCache cache_;
  std::mutex mutex_;  ///< guards all below
  std::condition_variable changed_;
  std::deque<std::shared_ptr<Task>> tasks_;
  std::list<std::pair<std::string, std::shared_ptr<const PictureTimes>>> times_;  ///< by folder
  std::atomic<bool> is_stopping_ = false;
  static constexpr size_t kNumThreads = 2;
  std::array<std::string, kNumThreads> open_;  ///< by thread: the folder of the log it has open
  std::array<std::thread, kNumThreads> threads_;
};

}  // namespace parkade
