#include "server/store/disk/ballast.h"

#include <fcntl.h>
#include <unistd.h>

#include <system_error>

#include "core/log.h"
#include "server/store/disk/durable_file.h"

namespace parkade {
namespace {

constexpr std::int64_t kBytes = std::int64_t{32} << 20;
constexpr std::int64_t kTooLittle = std::int64_t{8} << 20;  // for the database to do its work
constexpr std::int64_t kPlenty = 8 * kBytes;

}  // namespace

Ballast::Ballast(std::filesystem::path file) : file_(std::move(file)) {
  if (FreeBytes(file_.parent_path()) < kTooLittle) {
    Drop();
  } else {
    Restore();
  }
}

bool Ballast::Drop() {
  std::error_code ignored;
  const bool was_there = std::filesystem::remove(file_, ignored);
  if (was_there) LogWarning("the disk of the data directory is full: its ballast is dropped");
  return was_there;
}

void Ballast::Restore() {
  std::error_code ignored;
  const bool has_room = FreeBytes(file_.parent_path()) > kPlenty;
  if (!has_room || std::filesystem::exists(file_, ignored)) return;
  const int fd = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (fd < 0) return;
  const bool is_there = ::fallocate(fd, 0, 0, kBytes) == 0;
  ::close(fd);
  if (!is_there) std::filesystem::remove(file_, ignored);
}

}  // namespace parkade
