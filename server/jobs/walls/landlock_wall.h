#pragma once

#include <string>
#include <vector>

#include "server/jobs/walls/file_rules.h"

namespace parkade {

/// Keeps a process from writing anywhere but in the writable folders of FileRules and to /dev/null
/// and the like, by Landlock: where no mount namespace can be had. It hides nothing.
class LandlockWall {
 public:
  /// Before fork.
  explicit LandlockWall(const FileRules& rules);

  /// Between fork and exec: async-signal-safe. False where the kernel has no Landlock (5.19 and
  /// later do). It sets PR_SET_NO_NEW_PRIVS.
  bool Raise() const;

 private:
  std::vector<std::string> folders_;
};

}  // namespace parkade
