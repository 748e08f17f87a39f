#pragma once

#include <string>
#include <vector>

#include "server/ingest/log_scanner.h"

namespace parkade {

/// Which messages of a chunk could be read.
struct KeptMessages {
  std::vector<std::uint64_t> offsets;  ///< of their records in the unpacked chunk, increasing
};

/// Adds to `damage` what is missing of a chunk, per topic, as far as the index records behind the chunk tell.
/// `problem`: one sentence.
void AddChunkLoss(const ScannedLog& log, const LogRecord& chunk, const std::string& problem, const KeptMessages& kept,
                  const std::vector<bool>& wanted, DamageReport& damage);

}  // namespace parkade
