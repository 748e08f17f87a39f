#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/jobs/walls/file_rules.h"

namespace parkade {

/// Holds a process to FileRules by a mount namespace of its own, as bubblewrap does: everything is
/// read-only and without devices but for /dev/null and the like; `hidden` and /run are empty but
/// for what the rules name; /proc shows its own processes only.
class MountWall {
 public:
  /// Before fork. Throws Error{kInternal} where a writable folder is not there.
  explicit MountWall(const FileRules& rules);

  /// Between fork and exec: async-signal-safe. False, and nothing has changed, where the kernel
  /// does not allow it.
  bool Raise();

 private:
  struct Shown {
    std::string path;
    bool is_folder = true, is_writable = false, is_device = false;
    std::vector<std::string> parents = {};  ///< to be made, the uppermost first
    int tree = -1;                          ///< file descriptor of what is to appear there
  };

  void Cover(const std::filesystem::path& folder);
  void Show(const std::filesystem::path& path, bool is_writable);
  bool IsCovered(const std::filesystem::path& path) const;
  bool Build();
  static bool Pick(Shown& shown);
  static bool Place(const Shown& shown);

  std::vector<std::string> covered_;
  std::vector<Shown> shown_;  ///< in order of their paths: what holds another comes first
};

}  // namespace parkade
