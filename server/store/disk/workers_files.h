#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "server/store/disk/file_handle.h"

namespace parkade {

// What a worker left is read with distrust. Where a plain file is expected, a hostile log may have
// made it put a link to somebody else's file, a pipe that keeps the reader waiting, or a device.

/// Opens a plain file for reading, whose folder is a folder; neither is reached through a link.
/// Opens nothing else. Never waits.
FileHandle OpenWorkersFile(const std::filesystem::path& file);

/// The content of such a file. Throws Error{kNotFound} where there is none, Error{kInvalidInput}
/// above `max_bytes`.
std::string ReadWorkersFile(const std::filesystem::path& file, std::size_t max_bytes);

/// Moves a folder out of a worker's folder to `to`, which does not exist. Throws Error{kInternal}
/// where it is no folder, or is reached through a link.
void TakeWorkersFolder(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace parkade
