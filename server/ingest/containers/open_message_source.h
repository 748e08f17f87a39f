#pragma once

#include <filesystem>
#include <memory>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// Opens a ROS 1 bag (v2.0), an MCAP file, a rosbag2 sqlite3 file, any of them packed with zstd as
/// a whole, or a folder of one recording in several files, with or without metadata.yaml. Files are
/// recognized by their content, never by name; a file whose beginning is damaged is known by its
/// records. In a folder other files are passed over.
///
/// A packed file is unpacked to a temporary one in `scratch_folder` (empty: TMPDIR), which lives as
/// long as the source and its passes; so does the copy of a database that has a `-wal` file.
///
/// Throws Error{kInvalidInput} with one sentence when it is none of these, Error{kNotFound}, and
/// Error{kDiskFull}. Damage is no error: see MessageStream::damage().
std::unique_ptr<MessageSource> OpenMessageSource(const std::filesystem::path& log,
                                                 const std::filesystem::path& scratch_folder = {});

}  // namespace parkade
