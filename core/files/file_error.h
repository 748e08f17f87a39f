#pragma once

#include <filesystem>
#include <string>

namespace parkade {

/// Throws Error{kDiskFull} where `error` says so, else Error{kInternal}; `what` becomes the
/// sentence's beginning.
[[noreturn]] void ThrowErrno(const std::string& what, int error);

/// The same for a stream that failed, which does not say why.
[[noreturn]] void ThrowCannotWrite(const std::filesystem::path& file);

}  // namespace parkade
