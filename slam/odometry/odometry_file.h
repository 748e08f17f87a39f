#pragma once

#include <filesystem>

#include "slam/odometry/odometry_result.h"

namespace parkade {

/// Writes everything that the odometry found about a drive, measurements included, so that loops
/// can be closed and maps made again without tracking: binary, little-endian, with a version and a
/// checksum. About 100 KB per second of the drive. Whole or not at all. Models of the lenses stay
/// in the rig. `rig` is the log's, with which the drive was tracked.
void WriteOdometry(const OdometryResult& odometry, const Rig& rig,
                   const std::filesystem::path& file);

/// Reads what WriteOdometry wrote about a drive with this very rig. Throws Error{kNotFound} without
/// the file, Error{kInvalidInput} where it is damaged, of another version, or of another
/// calibration.
OdometryResult ReadOdometry(const std::filesystem::path& file, const Rig& rig);

/// The same without the measurements, which are most of it, for a file that is known to be whole:
/// its checksum is not asked.
OdometryResult ReadOdometryAlone(const std::filesystem::path& file, const Rig& rig);

}  // namespace parkade
