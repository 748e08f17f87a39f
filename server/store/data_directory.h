#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "server/store/quarantine.h"

namespace parkade {

/// The folder that holds everything a service keeps, and the promise that no
/// second service uses it. Nothing a user names becomes a path in it: content
/// lies under its SHA-256, everything else under generated ids.
///
///   LOCK                    held as long as this object lives
///   db/main.db              the truth (server/store/tables/database.h)
///   db/ballast              room for the day when the disk is full
///   uploads/<id>            logs that arrive in parts, of an upload or of a set
///   logs/ab/<sha256>        drive logs as uploaded, read-only
///   rigs/<id>/              rig files
///   maps/<id>/              published maps, never changed
///   jobs/<id>/attempt-<n>/  log and input of an attempt at a job
///   jobs/<id>/worker/       where the workers of the job write, and nowhere else: what lies there
///                           is not trusted
///   jobs/<id>/worker/work/  results of its stages, for its next attempt; may go at any time
///   pictures/<drive>/       pictures of its log that people looked at; may go at any time
///   tmp/                    uploads by one request, comparisons of maps; emptied at start
///   quarantine/             what was found without a row in the database; kept for a month
class DataDirectory {
 public:
  static constexpr const char* kWorkerFolder = "worker";  ///< in a job's folder

  /// Creates what is missing and takes the lock. Throws Error{kConflict} when
  /// another process holds it.
  explicit DataDirectory(const std::filesystem::path& root);
  ~DataDirectory();
  DataDirectory(const DataDirectory&) = delete;
  DataDirectory& operator=(const DataDirectory&) = delete;

  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path DatabaseFile() const { return root_ / "db" / "main.db"; }
  std::filesystem::path LogsFolder() const { return root_ / "logs"; }
  std::filesystem::path RigsFolder() const { return root_ / "rigs"; }
  std::filesystem::path MapsFolder() const { return root_ / "maps"; }
  std::filesystem::path JobsFolder() const { return root_ / "jobs"; }
  std::filesystem::path UploadsFolder() const { return root_ / "uploads"; }
  std::filesystem::path PicturesFolder() const { return root_ / "pictures"; }

  /// Where a log lies, relative to the root.
  static std::string LogPath(const std::string& sha256) {
    return "logs/" + sha256.substr(0, 2) + "/" + sha256;
  }
  std::filesystem::path LogFile(const std::string& sha256) const { return root_ / LogPath(sha256); }
  std::filesystem::path UploadFile(const std::string& upload_id) const {
    return UploadsFolder() / upload_id;
  }
  std::filesystem::path RigFolder(const std::string& rig_id) const { return RigsFolder() / rig_id; }
  std::filesystem::path MapFolder(const std::string& map_id) const { return MapsFolder() / map_id; }
  std::filesystem::path JobFolder(const std::string& job_id) const { return JobsFolder() / job_id; }
  std::filesystem::path AttemptFolder(const std::string& job_id, int attempt) const;
  std::filesystem::path WorkerFolder(const std::string& job_id) const {
    return JobFolder(job_id) / kWorkerFolder;
  }
  std::filesystem::path WorkFolder(const std::string& job_id) const {
    return WorkerFolder(job_id) / "work";
  }
  /// Removes what the workers of a job have left but for WorkFolder. What cannot go stays.
  void RemoveLeftovers(const std::string& job_id) const;
  /// What the map of an attempt will look like, once its worker knows.
  std::filesystem::path PreviewFile(const std::string& job_id, int attempt) const;

  /// The folder in tmp/ where the comparison of two published maps is kept.
  std::filesystem::path ComparisonFolder(const std::string& from_map,
                                         const std::string& to_map) const {
    return root_ / "tmp" / ("compare-" + from_map + "-" + to_map);
  }

  /// A path in tmp/ that is not in use.
  std::filesystem::path NewTemporaryPath() const;

  /// A time before which everything was in order with the files of ended jobs, by what LOCK says;
  /// empty where that is nothing or lies in the future.
  std::string ReconciledUntil() const;
  /// Says so for the time that was, less a day: clocks are put back. On a full disk it may not
  /// last.
  void NoteReconciled(std::chrono::system_clock::time_point time) const;

  /// Moves a path to quarantine/.
  void PutAside(const std::filesystem::path& path) const { quarantine_.Take(path, root_); }
  const Quarantine& quarantine() const { return quarantine_; }

 private:
  std::filesystem::path root_;
  int lock_fd_ = -1;
  mutable Quarantine quarantine_;
};

}  // namespace parkade
