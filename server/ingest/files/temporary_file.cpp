#include "server/ingest/files/temporary_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "core/error.h"

namespace parkade {

TemporaryFile::TemporaryFile(const std::filesystem::path& folder) {
  std::string name =
      (folder.empty() ? std::filesystem::temp_directory_path() : folder) / "parkade-XXXXXX";
  const int descriptor = ::mkstemp(name.data());
  const bool is_full = errno == ENOSPC || errno == EDQUOT;
  Require(descriptor >= 0, is_full ? ErrorCode::kDiskFull : ErrorCode::kInternal,
          "cannot create a temporary file: " + std::string(std::strerror(errno)));
  ::close(descriptor);
  path_ = name;
}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace parkade
