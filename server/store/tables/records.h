#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace parkade {

// The rows of the database. Times are RFC 3339 in UTC. `sequence` orders rows by arrival and is
// what cursors of lists are made of.

enum class DriveState { kReceived, kQueued, kProcessing, kReady, kFailed };
enum class JobState { kQueued, kRunning, kDone, kFailed, kCancelled };
/// What people have decided about a map version.
enum class ReviewState { kDraft, kInReview, kApproved, kRejected };

/// "received", "queued", ...: as the contract spells them.
const char* ToText(DriveState state);
const char* ToText(JobState state);
const char* ToText(ReviewState state);
/// Throw Error{kInternal} for other words: only rows of ours are read back.
DriveState DriveStateFromText(const std::string& text);
JobState JobStateFromText(const std::string& text);
ReviewState ReviewStateFromText(const std::string& text);

/// A list in JSON for `json_each` of a query; nothing for none.
std::optional<std::string> JsonOf(const std::vector<ReviewState>& states);

// What a first look at a log found. Its job waits until there was one.
inline const std::string kWaiting = "waiting";
inline const std::string kClean = "clean";
inline const std::string kLossy = "lossy";
inline const std::string kUnusable = "unusable";
inline const std::string kNotInspected = "failed";  ///< the look itself failed

struct DriveInspection {
  std::string state;                 ///< one of the words above
  std::optional<std::string> json;   ///< as `parkade inspect --json` says it
  std::optional<std::string> error;  ///< why no map can be made, one sentence
};

struct Drive {
  std::int64_t sequence = 0;
  std::string id;
  std::string name;      ///< plain name, of the output folder of this drive in a map
  std::string filename;  ///< as the user called it; shown, never used as a path
  std::string site;
  std::optional<std::string> rig;
  DriveState state = DriveState::kReceived;
  std::optional<std::string> error;  ///< one sentence
  std::int64_t bytes = 0;
  std::string sha256;
  std::optional<std::string> streams;           ///< JSON from the last map's report.json
  std::optional<std::string> inspection_state;  ///< one of the words below; nothing: never asked
  std::optional<std::string> created_by;        ///< id of the token it came with
  std::string created_at, updated_at;
  std::optional<std::string> job;             ///< the latest one
  std::optional<std::int64_t> map_version;    ///< the latest one made from this drive
  std::optional<std::string> log_deleted_at;  ///< by the retention of its site
};

/// A reviewer's wishes for a map that is built anew from an existing one.
struct MapReview {
  std::optional<std::int64_t> from_version =
      {};  ///< of the site: its odometry is taken instead of tracking again
  std::vector<std::string> rejected_loops = {};  ///< [DRIVE:]LOOP as report.json names them
  std::vector<std::string> forced_loops = {};    ///< [DRIVE:]LOOP as report.json names them
  std::vector<std::string> rejected_links = {};  ///< DRIVE:KEYFRAME~DRIVE:KEYFRAME
  std::vector<std::string> forced_links = {};    ///< the same
  std::optional<std::vector<std::string>> pins =
      {};  ///< `parkade map --pin`; nothing: as the version has them
};

/// The engine whose attempts are child processes of the service.
inline const std::string kLocalEngine = "local";

/// Where the running attempt of a job is.
struct JobPlace {
  std::string engine;                    ///< kLocalEngine, "slurm"
  std::optional<std::string> id = {};    ///< what the engine calls it, once it has it
  bool waits = false;                    ///< in the engine's own queue
  std::optional<std::int64_t> pid = {},  ///< of a worker on this machine
      pid_started = {};                  ///< in clock ticks since boot
  bool operator==(const JobPlace&) const = default;
};

struct Job {
  std::int64_t sequence = 0;
  std::string id;
  std::string site;
  /// Ids of the drives, in the order of the command line. A job with a new drive has that one while
  /// it waits, and all that it is joined with once it was started.
  std::vector<std::string> drives;
  std::optional<std::string>
      new_drive;  ///< an upload's, to be joined with its site; nothing: `drives` were chosen
  MapReview review;
  JobState state = JobState::kQueued;
  int attempt = 0;       ///< how often a worker was started
  int crashes = 0;       ///< of these, ended by a signal since it was queued by hand
  int service_ends = 0;  ///< of these, ended because the service died since it was queued by hand
  std::optional<std::string> error;       ///< one sentence
  std::optional<std::string> error_code;  ///< "invalid_input", "crashed", ...
  std::optional<std::string> not_before;  ///< of a queued job that waits after a crash
  bool is_cancel_asked = false;           ///< of a running one, which is to end as cancelled
  std::optional<JobPlace> place;          ///< of the latest attempt, once an engine has it
  std::optional<std::string> last_stage;  ///< of an attempt that ended without a map
  std::optional<std::int64_t> map_version;
  std::string created_at;
  std::optional<std::string> started_at, finished_at;
};

/// The state as people see it: a job that waits in the queue of its engine is queued.
inline JobState ShownState(const Job& job) {
  const bool waits = job.state == JobState::kRunning && job.place && job.place->waits;
  return waits ? JobState::kQueued : job.state;
}

struct StoredRig {
  std::int64_t sequence = 0;
  std::string id;
  std::string name;
  std::string sha256;              ///< of the zip it is handed out as
  std::vector<std::string> files;  ///< names in its folder
  std::string created_at;
};

/// Something to be looked at before a version is decided on.
struct ChecklistItem {
  std::string id;    ///< plain name; what is ticked
  std::string text;  ///< one line
  bool operator==(const ChecklistItem&) const = default;
};

struct Site {
  std::int64_t sequence = 0;
  std::string name;
  std::string created_at;
  std::int64_t num_drives = 0;
  std::vector<std::int64_t> versions;              ///< ascending
  std::optional<std::string> datum, bounds;        ///< JSON of the latest version
  std::optional<std::int64_t> approved_version;    ///< the newest one
  std::optional<ReviewState> review_state;         ///< of the latest version
  std::string title;                               ///< one line; may be empty
  std::string note;                                ///< may be empty
  std::optional<std::int64_t> log_days, map_days;  ///< [days] that they are kept; nothing: for ever
  std::optional<std::string> default_rig;          ///< of uploads to the site that name none
  std::optional<std::vector<ChecklistItem>>
      review_checklist;  ///< its own; nothing: the usual one (UsualChecklist)
};

struct MapFile {
  std::string name;  ///< plain relative path
  std::int64_t bytes = 0;
  std::string sha256;
  std::string pieces = {};  ///< FileSums::pieces; empty where an older program published it
};

struct MapVersion {
  std::int64_t sequence = 0;
  std::string id;
  std::string site;
  std::int64_t version = 0;
  std::string job;
  std::string sha256;                        ///< of the manifest
  std::optional<std::string> datum, bounds;  ///< JSON from report.json
  std::string created_at;
  ReviewState review_state = ReviewState::kDraft;
  std::optional<std::string> files_deleted_at;  ///< by the retention of its site
  std::vector<MapFile> files;                   ///< sorted by name
  std::vector<Drive> drives;
};

/// A part of a list, newest first.
struct Page {
  int limit = 50;
  std::int64_t before =
      std::numeric_limits<std::int64_t>::max();  ///< sequence of the last row of the page before
};

}  // namespace parkade
