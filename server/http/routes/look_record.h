#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "server/store/tables/database.h"

namespace parkade {

/// Writes down in the audit log who looks at a drive's pictures: once for each caller, drive and
/// hour, since a look takes hundreds of pictures. Thread-safe.
class LookRecord {
 public:
  /// Throws where it cannot be written: nobody looks unseen then.
  void Note(Database& database, const std::string& drive);

 private:
  std::mutex mutex_;
  std::map<std::string, std::int64_t> hours_;  ///< by caller and drive: of the last entry
};

}  // namespace parkade
