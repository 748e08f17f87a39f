#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "server/jobs/walls/file_wall.h"
#include "server/jobs/walls/worker_limits.h"

namespace parkade {

/// All that a worker needs at its start, prepared before fork: after it, only async-signal-safe
/// calls are allowed, because other threads may have held locks.
struct WorkerLaunch {
  std::vector<char*> arguments, environment;
  std::string folder;  ///< to run in
  FileWall wall;
  WorkerLimits limits;
  int tasks_of_user = 0;  ///< processes and threads that run already
  std::vector<int> cgroup_fds;
  int log_fd = -1, input_fd = -1;
  bool says_walls = false;
  // Pipes to the service, each for a number.
  int process_fd = -1;         ///< takes the process that stands for the worker,
  int status_fd = -1;          ///< where that is an init: the worker's status of waitpid(2),
  int failure_fd = -1;         ///< the error of errno(3) that kept the worker from its start
  int failure_reader_fd = -1;  ///< its other end
};

/// The child of a fork becomes the worker, walled in as well as the kernel allows.
[[noreturn]] void RunWorker(WorkerLaunch& launch);

}  // namespace parkade
