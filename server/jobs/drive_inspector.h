#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "server/jobs/event_hub.h"
#include "server/jobs/inspect_command.h"
#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

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
