#include "server/commands/failure.h"

#include <new>
#include <opencv2/core.hpp>
#include <system_error>

#include "core/error.h"

namespace parkade {
namespace {

Failure FailureOf(const Error& error) {
  switch (error.code()) {
    case ErrorCode::kInvalidInput:
    case ErrorCode::kNotFound: return {error.what(), "invalid_input", WorkerStatus::kInvalidInput};
    case ErrorCode::kUsage: return {error.what(), "usage", WorkerStatus::kUsage};
    case ErrorCode::kDiskFull: return {error.what(), "disk_full", WorkerStatus::kDiskFull};
    case ErrorCode::kConflict:
    case ErrorCode::kForbidden:
    case ErrorCode::kInternal: break;
  }
  return {error.what(), "internal", WorkerStatus::kInternal};
}

bool IsForMemory(const std::exception& exception) {
  if (dynamic_cast<const std::bad_alloc*>(&exception) != nullptr) return true;
  const auto* of_opencv = dynamic_cast<const cv::Exception*>(&exception);
  return of_opencv != nullptr && of_opencv->code == cv::Error::StsNoMem;
}

bool IsForDisk(const std::exception& exception) {
  const auto* of_system = dynamic_cast<const std::system_error*>(&exception);
  return of_system != nullptr && of_system->code() == std::errc::no_space_on_device;
}

}  // namespace

Failure FailureOf(const std::exception& exception) {
  if (const auto* error = dynamic_cast<const Error*>(&exception)) return FailureOf(*error);
  if (IsForMemory(exception)) return {"out of memory", "out_of_memory", WorkerStatus::kOutOfMemory};
  if (IsForDisk(exception)) return {"the disk is full", "disk_full", WorkerStatus::kDiskFull};
  return {std::string("internal error: ") + exception.what(), "internal", WorkerStatus::kInternal};
}

}  // namespace parkade
