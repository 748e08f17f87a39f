#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace parkade {

/// True for files that begin like a zip, a tar, or a tar compressed with gzip or zstd.
bool IsArchive(const std::filesystem::path& file);

struct ExtractionResult {
  std::uint64_t num_files = 0;
  std::string damage;  ///< why the archive could not be read to its end; empty: it could
};

/// Unpacks the EuRoC drive in an archive (its mav0, at most three folders deep) into `target`, in
/// one pass.
///
/// Safe against any archive: a file is only made under a name that is built from the parts that an
/// EuRoC folder has
/// (`cam0/data/<plain name>`, ...), links and devices are passed over, and at most 8 times the
/// archive's size plus 64 MiB is written, in at most a million files. Throws Error{kInvalidInput}
/// beyond these limits, for entries that lead outside, and when there is no EuRoC drive, or
/// several; Error{kDiskFull} when there is no room.
ExtractionResult ExtractEurocArchive(const std::filesystem::path& archive,
                                     const std::filesystem::path& target);

}  // namespace parkade
