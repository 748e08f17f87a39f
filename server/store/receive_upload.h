#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

/// What an upload says about itself.
struct NewDrive {
  std::string filename;             ///< as the user calls it; may be empty
  std::optional<std::string> site;  ///< plain name; default: a new site named after the file
  std::optional<std::string>
      rig;  ///< name of a stored rig; default: the site's, else what the log itself holds
};

struct ReceivedDrive {
  Drive drive;
  Job job;
};

/// Call before the first byte is taken. Throws Error{kInvalidInput} when the names are not usable
/// or the rig does not exist.
void CheckNewDrive(Store& store, const NewDrive& drive);

/// A log that is finished and synced, in the data directory.
struct ArrivedLog {
  std::filesystem::path path;
  std::int64_t bytes = 0;
  std::string sha256;
};

/// Stores a log as a drive of its site and queues the job that maps it: joined with its site as it
/// is when the job starts where `merge_drives`, alone otherwise. `also` is done in the same
/// transaction. Durable when it returns. Equal logs share one file. The log keeps its old name,
/// too.
ReceivedDrive ReceiveDrive(
    Store& store, const NewDrive& drive, const ArrivedLog& log, bool merge_drives,
    const std::function<void(Connection&, const Drive&)>& also = [](Connection&, const Drive&) {});

/// Deletes a drive and its log; maps made from it stay. Throws Error{kNotFound},
/// Error{kConflict} while it waits for a map or a job that uses it runs.
void DeleteDrive(Store& store, const std::string& id);

/// Deletes a log that no drive has any more. Call after the commit that took it from the last.
void RemoveUnusedLog(Store& store, const std::string& sha256);

}  // namespace parkade
