#include "server/jobs/drive_inspector.h"

#include <sys/wait.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/foreign_json.h"
#include "core/log.h"
#include "server/jobs/last_sentence.h"
#include "server/jobs/worker_process.h"
#include "server/store/disk/workers_files.h"
#include "server/store/job_queue.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/rig_table.h"
#include "server/store/temporary_path.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::minutes kTimeLimit{15};  // for one log
constexpr std::chrono::milliseconds kPatience{100};
constexpr std::chrono::seconds kLookInterval{30};
constexpr size_t kMaxBytes = size_t{4} << 20;

// The job may have better luck, and says what is wrong otherwise.
const DriveInspection kNothingFound{.state = kNotInspected, .json = {}, .error = {}};

std::string Joined(const nlohmann::json& sentences) {
  std::string text;
  for (const nlohmann::json& sentence : sentences)
    text += (text.empty() ? "" : "; ") + sentence.get<std::string>();
  return text;
}

/// What the process left. Its own state says how much can be read; without a rig, say, all of it
/// can, and no map can be made.
DriveInspection UnderstandInspection(const fs::path& file, const std::string& filename) {
  nlohmann::json json = ParseForeignJson(ReadWorkersFile(file, kMaxBytes));
  Require(json.is_object(), ErrorCode::kInternal, "the inspection left no JSON");
  json["name"] = filename;
  DriveInspection inspection;
  inspection.state = json.at("state");
  if (!json.at("missing").empty()) {
    inspection.state = kUnusable;
    inspection.error = Joined(json.at("missing"));
  } else if (inspection.state == kUnusable) {
    inspection.error = "the log cannot be mapped: its inspection says why";
  }
  inspection.json = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return inspection;
}

}  // namespace

DriveInspector::DriveInspector(Store& store, EventHub& events, InspectCommand command,
                               std::function<void()> on_inspected)
    : store_(store),
      events_(events),
      command_(std::move(command)),
      on_inspected_(std::move(on_inspected)),
      thread_([this] { Work(); }) {}

DriveInspector::~DriveInspector() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void DriveInspector::Wake() {
  {
    const std::lock_guard lock(mutex_);
    has_news_ = true;
  }
  changed_.notify_all();
}

bool DriveInspector::is_stopping() {
  const std::lock_guard lock(mutex_);
  return is_stopping_;
}

void DriveInspector::Work() {
  while (!is_stopping()) {
    try {
      if (const std::optional<Drive> drive = store_.database.Read(NextDriveToInspect)) {
        Finish(*drive, Inspect(*drive));
        continue;
      }
    } catch (const DiskFailure& failure) {
      store_.database.Freeze(failure.what());
    } catch (const Error& error) {
      LogError(std::string("inspection error=") + error.what());  // a full disk: try again later
    }
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kLookInterval, [this] { return is_stopping_ || has_news_; });
    has_news_ = false;
  }
}

/// Nothing where the service ends meanwhile; the next one does it again.
std::optional<DriveInspection> DriveInspector::Inspect(const Drive& drive) {
  try {
    return RunInspection(drive);
  } catch (const DiskFailure&) {
    throw;
  } catch (const std::exception& error) {
    if (const auto* known = dynamic_cast<const Error*>(&error);
        known != nullptr && known->code() == ErrorCode::kDiskFull)
      throw;
    LogWarning("inspection failed drive=" + drive.id + " error=" + error.what());
    return kNothingFound;
  }
}

std::optional<DriveInspection> DriveInspector::RunInspection(const Drive& drive) {
  const TemporaryPath folder(store_.directory.NewTemporaryPath());
  fs::create_directory(folder.get());
  const fs::path out = folder.get() / "inspection.json", log = folder.get() / "log.txt";
  std::optional<fs::path> rig;
  if (drive.rig)
    if (const auto stored = store_.database.Read(
            [&](Connection& connection) { return FindRig(connection, *drive.rig); }))
      rig = store_.directory.RigFolder(stored->id);

  std::optional<int> status;
  {
    const fs::path input = store_.directory.LogFile(drive.sha256);
    WorkerProcess process(command_(input, rig, out),
                          {.folder = folder.get(),
                           .log = log,
                           .temporary_files = folder.get(),
                           .hidden = store_.directory.root(),
                           .visible = {input, rig.value_or(fs::path())}});
    const auto end = std::chrono::steady_clock::now() + kTimeLimit;
    while (!(status = process.Wait(kPatience))) {
      if (is_stopping()) return std::nullopt;
      if (std::chrono::steady_clock::now() > end) break;
    }
  }
  const bool has_ended = status && WIFEXITED(*status);
  if (has_ended && fs::exists(out)) return UnderstandInspection(out, drive.filename);
  if (has_ended && WEXITSTATUS(*status) == 1)
    return DriveInspection{.state = kUnusable, .json = {}, .error = LastSentence(log)};
  LogWarning("inspection gave nothing drive=" + drive.id);
  return kNothingFound;
}

void DriveInspector::Finish(const Drive& drive, const std::optional<DriveInspection>& inspection) {
  if (!inspection) return;
  RecordInspection(store_, drive.id, *inspection);
  events_.Publish("drive", drive.id);
  if (drive.job) events_.Publish("job", *drive.job);
  on_inspected_();
}

}  // namespace parkade
