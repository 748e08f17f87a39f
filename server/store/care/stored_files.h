#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/store/store.h"

namespace parkade {

/// A file, or the folder of a rig, that the database answers for.
struct StoredFile {
  std::string path;  ///< relative to the data directory
  std::int64_t bytes = 0;
  std::string sha256;    ///< of a rig: of the zip it is handed out as
  std::string rig = {};  ///< id of the rig that the folder is of
};

/// The logs of all drives, the files of all map versions and all rigs.
std::vector<StoredFile> StoredFiles(Connection& connection);

/// False once the last drive with this log was deleted, or the files of the map version were.
bool IsStored(Connection& connection, const std::string& path);

/// Whether a file is there in the data directory `data`, as long as it should be, without reading
/// it: nothing where it is, else what is wrong, as in "is missing".
std::optional<std::string> LookAtStoredFile(const std::filesystem::path& data,
                                            const StoredFile& file);

/// Reads it whole and compares the SHA-256. `go_on` is asked after every MiB; nothing is known,
/// and nothing returned, where it says false.
std::optional<std::string> CheckStoredFile(
    const std::filesystem::path& data, const StoredFile& file,
    const std::function<bool()>& go_on = [] { return true; });

/// Notes in the log and the database what is wrong with a file, or that nothing is; nothing at all
/// of one that is not stored any more, and therefore missing.
void RecordFileCheck(Store& store, const std::string& path,
                     const std::optional<std::string>& damage);

}  // namespace parkade
