#pragma once

#include <map>
#include <mutex>
#include <vector>

#include "core/timestamp.h"

namespace parkade {

/// Images of a drive that were decoded once and had no damage: another pass over the drive need not
/// look for it again. Thread-safe. Eight bytes an image.
class IntactImages {
 public:
  /// Each stream has one image at a time.
  bool Has(int stream, Timestamp time) const;
  /// Fast where images come almost in the order of their times.
  void Add(int stream, Timestamp time);

 private:
  mutable std::mutex mutex_;
  std::map<int, std::vector<Timestamp>> times_;  ///< by stream, ascending; guarded by mutex_
};

}  // namespace parkade
