#pragma once

#include <string>

#include "core/error.h"

namespace parkade {

/// The disk of the data directory said that it did not keep what it was given (a sync or a write
/// failed other than for want of room). The kernel may have dropped the data and may say at the
/// next sync that all is well, so nothing is tried again: what was asked for is not acknowledged,
/// nothing is deleted, since it may be there after all, and Database::Freeze lets nothing more be
/// written. The next start finds out what is there.
class DiskFailure : public Error {
 public:
  explicit DiskFailure(const std::string& what) : Error(ErrorCode::kInternal, what) {}
};

}  // namespace parkade
