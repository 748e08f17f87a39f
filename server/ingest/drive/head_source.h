#pragma once

#include <memory>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// How much of a log a first look takes in.
struct HeadLimits {
  double seconds = 20;
  double min_seconds = 5;                              ///< however many bytes these are
  std::uint64_t num_bytes = std::uint64_t{512} << 20;  ///< of messages
};

/// A log as if it ended early: each pass ends where one of the limits is reached.
std::shared_ptr<const MessageSource> HeadOf(std::shared_ptr<const MessageSource> source,
                                            const HeadLimits& limits);

}  // namespace parkade
