#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "server/ingest/drive/open_drive_log.h"

namespace parkade {

/// A clean log that was written.
struct ConvertedDrive {
  std::filesystem::path file;
  double seconds = 0;
  std::uint64_t num_messages = 0;
  std::uint64_t num_left_out = 0;  ///< messages of its sensors that could not be used
};

struct Conversion {
  std::vector<ConvertedDrive> drives;  ///< the longest first
  std::filesystem::path rig;           ///< the folder with their calibration
};

/// Writes what was understood of a log as a clean one (see clean_log.h) for any reader of ROS 2:
/// MCAP in chunks of zstd with an index. The rig comes beside `out`, as "NAME_rig"; further drives
/// of the log (see OpenDriveLogs) as "NAME_part2.mcap" and so on. All appear together once all are
/// whole. Memory does not grow with the log.
///
/// Throws as OpenDriveLog; Error{kInvalidInput} where one of the files exists already, or there is
/// no folder for them; Error{kUsage} where `out` is not called NAME.mcap; Error{kDiskFull}.
Conversion ConvertLog(const std::filesystem::path& log, const std::filesystem::path& out,
                      const OpenLogOptions& options);

/// The same for a log that is open already; `name` may be a file name.
Conversion ConvertLog(const std::shared_ptr<const MessageSource>& source,
                      const std::filesystem::path& name, const std::filesystem::path& out,
                      const OpenLogOptions& options);

}  // namespace parkade
