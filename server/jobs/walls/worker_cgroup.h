#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace parkade {

/// Control groups of the kernel's, version 1 or 2, that limit one worker's memory and how many
/// processes and threads it may have.
class WorkerCgroup {
 public:
  /// Makes them below this process's own, with limits of `memory` bytes and `tasks`, as far as
  /// there are controllers and the right to. Removes those that dead services left behind.
  WorkerCgroup(std::int64_t memory, int tasks);
  /// Removes the groups once their processes have ended.
  ~WorkerCgroup();
  WorkerCgroup(const WorkerCgroup&) = delete;
  WorkerCgroup& operator=(const WorkerCgroup&) = delete;

  /// A process that writes "0" to each of these files joins the groups.
  std::vector<std::filesystem::path> ProcessesFiles() const;
  /// The kernel ended a process for want of memory.
  bool HasKilled() const;
  /// The limit of memory was reached, not only the machine's.
  bool HasReachedLimit() const;
  /// Nothing where memory is not limited.
  std::optional<int> memory_version() const;
  bool limits_tasks() const { return limits_tasks_; }

 private:
  struct Group {
    std::filesystem::path folder;
    int version = 1;
  };

  static std::optional<Group> MakeGroup(const std::string& controller);
  static void Remove(const Group& group);

  std::int64_t memory_bytes_ = 0;
  std::optional<Group> memory_, tasks_;  ///< a group of version 2 limits both
  bool limits_tasks_ = false;
};

/// [bytes] nine tenths of the machine's memory, or of what this process's control group may use.
std::int64_t DefaultMemoryLimit();

/// How many processes the kernel ended for want of memory since boot, on the whole machine.
std::int64_t KernelMemoryKills();

}  // namespace parkade
