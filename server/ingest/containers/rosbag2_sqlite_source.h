#pragma once

#include <filesystem>
#include <memory>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// A rosbag2 sqlite3 file (.db3), read only and immutable: nothing beside it is made or changed.
/// Messages come by their timestamp where the file has its index, else in the order of writing.
/// Where the database is damaged, the pass goes on over its pages one by one (see SqlitePages).
/// Throws Error{kInvalidInput} when it is another kind of database.
std::unique_ptr<MessageSource> OpenRosbag2Sqlite(const std::filesystem::path& file);

}  // namespace parkade
