#include "core/files/file_error.h"

#include <cerrno>
#include <cstring>

#include "core/error.h"

namespace parkade {

void ThrowErrno(const std::string& what, int error) {
  const bool is_full = error == ENOSPC || error == EDQUOT;
  throw Error(is_full ? ErrorCode::kDiskFull : ErrorCode::kInternal,
              what + ": " + std::strerror(error));
}

void ThrowCannotWrite(const std::filesystem::path& file) {
  constexpr std::uintmax_t kAlmostFull = std::uintmax_t{1} << 20;
  std::error_code ignored;
  const bool is_full = std::filesystem::space(file.parent_path(), ignored).available < kAlmostFull;
  ThrowErrno("cannot write '" + file.string() + "'", is_full ? ENOSPC : EIO);
}

}  // namespace parkade
