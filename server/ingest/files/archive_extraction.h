#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace parkade {

/// True for files that begin like a zip, a tar, or a tar compressed with gzip or zstd.
bool IsArchive(const std::filesystem::path& file);

struct ExtractionResult {
  /// The folder of the log files; nothing where the drive is EuRoC's.
  std::optional<std::filesystem::path> log_folder;
  std::string damage;  ///< why the archive could not be read to its end; empty: it could
};

/// Unpacks the drive in an archive in one pass: the content of an EuRoC folder into `target`, log
/// files into a folder in it that is called as the archive.
///
/// Safe against any archive: files are only made at the places that ArchivePaths gives them, links
/// and devices are passed over, and at most 8 times the archive's size plus 64 MiB is written, in
/// at most a million files. Throws Error{kInvalidInput} beyond these limits, for entries that lead
/// outside, and when there is no drive, or several; Error{kDiskFull} when there is no room.
ExtractionResult ExtractArchive(const std::filesystem::path& archive,
                                const std::filesystem::path& target);

}  // namespace parkade
