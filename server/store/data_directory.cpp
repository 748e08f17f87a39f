#include "server/store/data_directory.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/log.h"
#include "server/store/disk/durable_file.h"
#include "server/store/tables/names.h"

namespace parkade {
namespace {

constexpr std::chrono::hours kClockError{24};

/// Tries for two seconds: a service that was killed while it started a worker
/// leaves a child that holds the lock until it notices.
bool TakeLock(int fd) {
  for (int attempt = 0; attempt < 40; ++attempt) {
    if (::flock(fd, LOCK_EX | LOCK_NB) == 0) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

/// "data/" has an empty last part otherwise.
std::filesystem::path WithoutLastSlash(const std::filesystem::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

}  // namespace

DataDirectory::DataDirectory(const std::filesystem::path& root)
    : root_(WithoutLastSlash(std::filesystem::absolute(root))), quarantine_(root_ / "quarantine") {
  CreateDurableFolder(root_);
  lock_fd_ = ::open((root_ / "LOCK").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  Require(lock_fd_ >= 0, ErrorCode::kInvalidInput,
          "cannot write to the data directory '" + root.string() + "': " + std::strerror(errno));
  if (!TakeLock(lock_fd_)) {
    ::close(lock_fd_);
    throw Error(ErrorCode::kConflict,
                "another service already uses the data directory '" + root.string() + "'");
  }
  for (const char* folder :
       {"db", "uploads", "logs", "rigs", "maps", "jobs", "pictures", "tmp", "quarantine"})
    CreateDurableFolder(root_ / folder);
  // These bytes were promised to nobody: their upload was never acknowledged.
  for (const auto& entry : std::filesystem::directory_iterator(root_ / "tmp"))
    std::filesystem::remove_all(entry.path());
  quarantine_.Tidy();
}

std::string DataDirectory::ReconciledUntil() const {
  const std::string now = NowUtc();
  std::string text(now.size(), '\0');
  const ssize_t size = ::pread(lock_fd_, text.data(), text.size(), 0);
  return size == static_cast<ssize_t>(text.size()) && text <= now ? text : "";
}

void DataDirectory::NoteReconciled(std::chrono::system_clock::time_point time) const {
  const std::string text = UtcText(time - kClockError);
  [[maybe_unused]] const ssize_t ignored = ::pwrite(lock_fd_, text.data(), text.size(), 0);
}

DataDirectory::~DataDirectory() { ::close(lock_fd_); }

std::filesystem::path DataDirectory::AttemptFolder(const std::string& job_id, int attempt) const {
  return JobFolder(job_id) / ("attempt-" + std::to_string(attempt));
}

void DataDirectory::RemoveLeftovers(const std::string& job_id) const {
  namespace fs = std::filesystem;
  std::error_code failed;
  std::vector<fs::path> leftovers;
  for (const fs::directory_entry& entry : fs::directory_iterator(WorkerFolder(job_id), failed))
    if (entry.path() != WorkFolder(job_id) || !fs::is_directory(entry.symlink_status(failed)))
      leftovers.push_back(entry.path());
  for (const fs::path& path : leftovers) fs::remove_all(path, failed);
}

std::filesystem::path DataDirectory::PreviewFile(const std::string& job_id, int attempt) const {
  return WorkerFolder(job_id) / ("attempt-" + std::to_string(attempt) + ".preview.glb");
}

std::filesystem::path DataDirectory::NewTemporaryPath() const { return root_ / "tmp" / NewId(); }

}  // namespace parkade
