#pragma once

#include <optional>
#include <string>

#include "server/store/disk/durable_file.h"
#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

/// What an upload says about itself.
struct NewDrive {
  std::string filename;             ///< as the user calls it; may be empty
  std::optional<std::string> site;  ///< plain name; default: a new site named after the file
  std::optional<std::string> rig;   ///< name of a stored rig; default: what the log itself holds
};

struct ReceivedDrive {
  Drive drive;
  Job job;
};

/// Call before the first byte is taken. Throws Error{kInvalidInput} when the names are not usable
/// or the rig does not exist.
void CheckNewDrive(Store& store, const NewDrive& drive);

/// Stores a finished log (GrowingFile::Finish gave `sha256`) as a drive of its
/// site and queues the job that maps it: joined with its site as it is when the job starts
/// where `merge_drives`, alone otherwise. Durable when it returns. Equal logs
/// share one file.
ReceivedDrive ReceiveDrive(Store& store, const NewDrive& drive, GrowingFile& log,
                           const std::string& sha256, bool merge_drives);

/// Deletes a drive and its log; maps made from it stay. Throws Error{kNotFound},
/// Error{kConflict} while it waits for a map or a job that uses it runs.
void DeleteDrive(Store& store, const std::string& id);

}  // namespace parkade
