#pragma once

#include <set>
#include <string>
#include <vector>

#include "server/ingest/containers/log_scanner.h"

namespace parkade {

/// Which messages of a chunk could be read.
class KeptMessages {
 public:
  void Add(std::uint32_t channel, Timestamp time);
  bool Contains(std::uint32_t channel, Timestamp time) const {
    return stamps_.contains({channel, time});
  }
  bool IsEmpty() const { return stamps_.empty(); }
  bool IsComplete() const {
    return is_complete_;
  }  ///< false: there were too many messages to note all

 private:
  std::set<std::pair<std::uint32_t, Timestamp>> stamps_;
  bool is_complete_ = true;
};

/// Adds to `damage` what is missing of a chunk, per topic, as far as the index records behind the
/// chunk tell. `problem`: one sentence.
void AddChunkLoss(const ScannedLog& log, const LogRecord& chunk, const std::string& problem,
                  KeptMessages kept, const std::vector<bool>& wanted, DamageReport& damage);

}  // namespace parkade
