#pragma once

#include <filesystem>
#include <memory>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// A log of any supported format, recognized by content: EuRoC folder or archive of one (unpacked
/// below `scratch_folder`), ROS 1 bag, MCAP, rosbag2. Throws Error{kNotFound} or
/// Error{kInvalidInput} with one sentence.
std::shared_ptr<const MessageSource> OpenLogSource(const std::filesystem::path& log,
                                                   const std::filesystem::path& scratch_folder);

}  // namespace parkade
