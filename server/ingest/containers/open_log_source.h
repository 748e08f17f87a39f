#pragma once

#include <filesystem>
#include <memory>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// A log of any supported format, recognized by content: EuRoC folder, ROS 1 bag, MCAP, rosbag2, a
/// folder of one recording in several files, or an archive of such a folder (unpacked below
/// `scratch_folder`). Throws Error{kNotFound} or Error{kInvalidInput} with one sentence.
std::shared_ptr<const MessageSource> OpenLogSource(const std::filesystem::path& log,
                                                   const std::filesystem::path& scratch_folder);

}  // namespace parkade
