#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/ingest/drive/open_drive_log.h"
#include "server/pipeline/built_map.h"
#include "server/pipeline/report.h"

namespace parkade {

/// Where maps lie that a build takes from and writes to; each but `out` may be empty.
struct BuildFolders {
  std::filesystem::path from, products, work;  ///< see StageCache
  std::filesystem::path out;                   ///< does not count where it lies in a log's folder
};

/// The drives of one map.
struct OpenedLogs {
  std::vector<std::unique_ptr<RecordedDrive>> drives;  ///< in the order of their time
  std::map<std::string, DriveInputs> inputs;           ///< by the drives' names
  std::vector<LeftOutDrive> unreadable;                ///< logs of several that cannot be used
};

/// Opens the logs of one map. What an earlier build found in a log is taken.
/// \param rigs  folders with rig files: none, one for all logs, or one for each; "-": the log's own
/// \param skips_bad  whether one of several logs that cannot be used is left out
/// Throws Error{kInvalidInput} where one cannot be used, with `skips_bad` where none can, or two
/// have one name, Error{kNotFound} for a log that is not there, and Error{kUsage} for another
/// number of rigs.
OpenedLogs OpenLogs(const std::vector<std::string>& logs, const std::vector<std::string>& rigs,
                    OpenLogOptions options, bool skips_bad, const BuildFolders& folders);

std::vector<std::string> NamesOf(const std::vector<std::unique_ptr<RecordedDrive>>& drives);

}  // namespace parkade
