#pragma once

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/event_hub.h"
#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

/// The command line that inspects a log, with the folder of its rig if any, and leaves what it
/// found in the file `out`: JSON with `state` and `missing` as `parkade inspect --json` has them.
/// When it fails with status 1 and no file, the last line that it prints is a sentence for the
/// user.
using InspectCommand = std::function<std::vector<std::string>(
    const std::filesystem::path& log, const std::optional<std::filesystem::path>& rig,
    const std::filesystem::path& out)>;

/// Looks at every log that arrives, in a process of its own, one at a time and before its job may
/// start: a log that cannot be mapped says why at once. Thread-safe.
class DriveInspector {
 public:
  /// Goes on with what an earlier service left; `on_inspected` is called after each, from the
  /// inspector's thread. Borrows store and events.
  DriveInspector(Store& store, EventHub& events, InspectCommand command,
                 std::function<void()> on_inspected);
  ~DriveInspector();
  DriveInspector(const DriveInspector&) = delete;
  DriveInspector& operator=(const DriveInspector&) = delete;

  /// Says that a drive waits.
  void Wake();

 private:
  void Work();
  std::optional<DriveInspection> Inspect(const Drive& drive);
  std::optional<DriveInspection> RunInspection(const Drive& drive);
  void Finish(const Drive& drive, const std::optional<DriveInspection>& inspection);
  bool is_stopping();

  Store& store_;
  EventHub& events_;
  const InspectCommand command_;
  const std::function<void()> on_inspected_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_stopping_ = false, has_news_ = true;
  std::thread thread_;
};

}  // namespace parkade
