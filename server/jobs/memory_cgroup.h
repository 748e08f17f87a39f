#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace parkade {

/// A control group of the kernel's, version 1 or 2, that one worker's memory is limited by.
class MemoryCgroup {
 public:
  /// Makes one below this process's own, with a limit of `bytes`. Null where there is no right to,
  /// or no memory controller. Removes those that dead services left behind.
  static std::unique_ptr<MemoryCgroup> Make(std::int64_t bytes);
  /// Removes the group once its processes have ended.
  ~MemoryCgroup();
  MemoryCgroup(const MemoryCgroup&) = delete;
  MemoryCgroup& operator=(const MemoryCgroup&) = delete;

  /// A process that writes "0" to this file joins the group.
  std::filesystem::path ProcessesFile() const { return folder_ / "cgroup.procs"; }
  /// The kernel ended a process of the group for want of memory.
  bool HasKilled() const;
  /// The group's own limit was reached, not only the machine's.
  bool HasReachedLimit() const;
  int version() const { return version_; }

 private:
  MemoryCgroup(std::filesystem::path folder, int version, std::int64_t bytes);

  std::filesystem::path folder_;
  int version_ = 1;
  std::int64_t bytes_ = 0;  ///< the limit
};

/// [bytes] nine tenths of the machine's memory, or of what this process's control group may use.
std::int64_t DefaultMemoryLimit();

/// How many processes the kernel ended for want of memory since boot, on the whole machine.
std::int64_t KernelMemoryKills();

}  // namespace parkade
