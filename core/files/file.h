#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "core/files/file_error.h"

namespace parkade {

/// Writes a file whole or not at all: to a temporary name beside it, fsync,
/// rename, fsync of the folder. Throws Error{kDiskFull} when there is no space,
/// Error{kInternal} otherwise, and then leaves nothing behind.
void WriteFileAtomically(const std::filesystem::path& file, std::string_view content);

/// The same for writers that want a path: `write` is given the temporary name.
void WriteFileAtomically(const std::filesystem::path& file,
                         const std::function<void(const std::filesystem::path&)>& write);

/// Copies a file, even a read-only one, to one that can be written to. Throws as ThrowErrno.
void CopyToWrite(const std::filesystem::path& from, const std::filesystem::path& to);

/// Whether a regular file is there; a name that no file can have is none. Never throws.
bool IsFile(const std::filesystem::path& path);

/// Returns the whole content. Throws Error{kNotFound}, or Error{kInvalidInput} for a folder and
/// above `max_bytes`.
std::string ReadFile(const std::filesystem::path& file,
                     std::size_t max_bytes = std::size_t{1} << 30);

}  // namespace parkade
