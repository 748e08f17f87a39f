#pragma once

#include <filesystem>
#include <string>

namespace parkade {

/// Whether rows of an SQLite database may lie in the write-ahead log beside it (`<database>-wal`),
/// where a recorder leaves them that was ended before its time.
bool HasWal(const std::filesystem::path& database);

/// The write-ahead log's name, without its folder.
std::string NameOfWal(const std::filesystem::path& database);

/// Copies a database and its write-ahead log to `copy`, the path of a file to be made, and writes
/// what was committed to the log into the copy. False when nothing in the log can be used. Throws
/// Error{kDiskFull}, and Error{kInvalidInput} for what cannot be read.
bool MergeWal(const std::filesystem::path& database, const std::filesystem::path& copy);

}  // namespace parkade
