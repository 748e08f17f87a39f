#pragma once

#include <memory>

#include "server/ingest/containers/log_format.h"
#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// A ROS 1 bag or MCAP file. Opening it hops over the headers; each pass merges overlapping chunks
/// by log time and holds at most about 64 MiB. Where more than that overlaps, messages come chunk
/// by chunk in the order of the file.
std::unique_ptr<MessageSource> OpenChunkedLog(std::shared_ptr<const InputFile> file,
                                              const LogFormat& format);

}  // namespace parkade
