#pragma once

#include <exception>
#include <string>

#include "server/jobs/job_spec.h"

namespace parkade {

/// What a failed run tells the service.
struct Failure {
  std::string sentence;
  std::string code;     ///< as in JobSpec::progress
  WorkerStatus status;  ///< of the process
};

/// Also of exceptions that other libraries throw for want of memory or room on the disk.
Failure FailureOf(const std::exception& exception);

}  // namespace parkade
