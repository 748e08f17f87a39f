#pragma once

#include <memory>
#include <vector>

#include "server/ingest/containers/log_format.h"
#include "server/ingest/containers/raw_message.h"
#include "server/ingest/containers/segment_list.h"

namespace parkade {

/// The result of one look at the headers of a log.
struct ScannedLog {
  std::shared_ptr<const InputFile> file;
  const LogFormat* format = nullptr;
  TopicMap topics;
  std::vector<LogSegment> segments;  ///< in order of the file; about 2 MiB or one chunk each
  DamageReport damage;               ///< of the structure; chunks are not unpacked yet
  bool is_set_back = false;  ///< the recorder's clock was, while it wrote; unknown where chunks
                             ///< have no index
};

/// Hops from header to header, past damage. Unpacks a chunk only where the headers leave open which
/// topics or times it holds.
ScannedLog ScanLog(std::shared_ptr<const InputFile> file, const LogFormat& format);

}  // namespace parkade
