// A disk that fails: the sync that FAIL_SYNC names, counted from 1, says EIO, and a mark is left in
// the file FAIL_SYNC_MARK. With LOSE_SYNCS all say yes and do nothing. These stand before the C
// library's, also for SQLite.

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

namespace {

bool FailsNow() {
  static std::atomic<int> count = 0;
  const char* which = std::getenv("FAIL_SYNC");
  if (which == nullptr || ++count != std::atoi(which)) return false;
  if (const char* mark = std::getenv("FAIL_SYNC_MARK"))
    ::close(::open(mark, O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
  errno = EIO;
  return true;
}

bool DoesNothing() {
  static const bool loses = std::getenv("LOSE_SYNCS") != nullptr;
  return loses;
}

}  // namespace

extern "C" int fsync(int fd) {
  if (DoesNothing()) return 0;
  return FailsNow() ? -1 : static_cast<int>(::syscall(SYS_fsync, fd));
}

extern "C" int fdatasync(int fd) {
  if (DoesNothing()) return 0;
  return FailsNow() ? -1 : static_cast<int>(::syscall(SYS_fdatasync, fd));
}
