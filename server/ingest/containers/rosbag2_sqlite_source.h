#pragma once

#include <filesystem>
#include <memory>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// A rosbag2 sqlite3 file (.db3), read only and immutable: nothing beside it is made or changed.
/// Messages come by their timestamp where the file has its index, else in the order of writing.
/// Rows in a `-wal` file beside it, which a recorder leaves that was ended before its time, are
/// read from a copy of both in `scratch_folder` (empty: TMPDIR). Where the database is damaged, the
/// pass goes on over its pages one by one (see SqlitePages). Throws Error{kInvalidInput} when it is
/// another kind of database, Error{kDiskFull}.
std::unique_ptr<MessageSource> OpenRosbag2Sqlite(const std::filesystem::path& file,
                                                 const std::filesystem::path& scratch_folder);

}  // namespace parkade
