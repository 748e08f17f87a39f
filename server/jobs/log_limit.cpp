#include "server/jobs/log_limit.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <vector>

namespace parkade {
namespace {

std::int64_t SizeOf(int file) {
  struct stat status {};
  return ::fstat(file, &status) == 0 ? status.st_size : 0;
}

/// Moves what lies from `from` on, also what is appended meanwhile, to `to`, and ends the file
/// there.
void MoveDown(int file, std::int64_t from, std::int64_t to) {
  std::vector<char> piece(std::size_t{1} << 20);
  while (from < SizeOf(file)) {
    const ssize_t size = ::pread(file, piece.data(), piece.size(), from);
    if (size <= 0 || ::pwrite(file, piece.data(), static_cast<std::size_t>(size), to) != size)
      break;
    from += size;
    to += size;
  }
  [[maybe_unused]] const int ignored = ::ftruncate(file, to);
}

}  // namespace

void LogLimit::Apply() {
  const int file = ::open(file_.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return;
  if (const std::int64_t size = SizeOf(file); size > kMost) {
    const std::int64_t from = size - kTail;
    left_out_ += from - kHead;
    const std::string note =
        "\n[" + std::to_string(left_out_ >> 20) + " MiB of this log were left out here]\n";
    const auto length = static_cast<std::int64_t>(note.size());
    if (::pwrite(file, note.data(), note.size(), kHead) == length)
      MoveDown(file, from, kHead + length);
  }
  ::close(file);
}

}  // namespace parkade
