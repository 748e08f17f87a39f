#pragma once

#include <string_view>

#include "server/jobs/walls/landlock_wall.h"
#include "server/jobs/walls/mount_wall.h"

namespace parkade {

/// Holds a process to FileRules as well as the kernel can.
class FileWall {
 public:
  /// Before fork. Throws Error{kInternal} where a writable folder is not there.
  explicit FileWall(const FileRules& rules) : mounts_(rules), landlock_(rules) {}

  /// Between fork and exec: async-signal-safe. Returns a line for the log that says what holds.
  std::string_view Raise() {
    if (mounts_.Raise()) return "the worker may write only in its own folder (mount namespace)\n";
    if (landlock_.Raise())
      return "the worker may write only in its own folder, and read anywhere (Landlock)\n";
    return "the worker may write anywhere, the kernel allows no other\n";
  }

 private:
  MountWall mounts_;
  LandlockWall landlock_;
};

}  // namespace parkade
