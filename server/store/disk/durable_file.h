#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace parkade {

/// For a failed write or sync: throws Error{kDiskFull} where `error` of errno(3) says so, else
/// DiskFailure.
[[noreturn]] void ThrowNotKept(int error);

/// Gives a finished and synced file a second name, in place of what has that name. Creates the
/// target's folder. Durable when it returns.
void KeepFile(const std::filesystem::path& file, const std::filesystem::path& target);

/// Lets nobody write to a finished file any more. Durable when it returns. Throws as SyncToDisk
/// does.
void MakeReadOnly(const std::filesystem::path& file);

/// fsync of a file or folder. Throws DiskFailure, or Error where it cannot be opened.
void SyncToDisk(const std::filesystem::path& path);

/// Creates `folder` and its missing parents and makes their entries durable.
void CreateDurableFolder(const std::filesystem::path& folder);

/// Bytes an unprivileged writer may still use on the filesystem of `path`.
std::int64_t FreeBytes(const std::filesystem::path& path);

}  // namespace parkade
