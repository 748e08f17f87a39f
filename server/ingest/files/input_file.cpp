#include "server/ingest/files/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"

namespace parkade {

InputFile::InputFile(const std::filesystem::path& file) : name_(file.filename().string()) {
  descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  Require(descriptor_ >= 0, ErrorCode::kNotFound,
          "cannot open '" + name_ + "': " + std::strerror(errno));
  struct stat status {};
  if (::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode)) {
    size_ = static_cast<std::uint64_t>(status.st_size);
    return;
  }
  ::close(descriptor_);
  throw Error(ErrorCode::kInvalidInput, "'" + name_ + "' is not a file");
}

InputFile::~InputFile() { ::close(descriptor_); }

std::size_t InputFile::ReadAt(std::uint64_t offset, std::span<std::uint8_t> out) const {
  std::size_t num_read = 0;
  while (num_read < out.size() && offset + num_read < size_) {
    const ssize_t count = ::pread(descriptor_, out.data() + num_read, out.size() - num_read,
                                  static_cast<off_t>(offset + num_read));
    if (count < 0 && errno == EINTR) continue;
    Require(count >= 0, ErrorCode::kInvalidInput,
            "cannot read '" + name_ + "': " + std::strerror(errno));
    if (count == 0) break;  // someone cut the file since
    num_read += static_cast<std::size_t>(count);
  }
  return num_read;
}

}  // namespace parkade
