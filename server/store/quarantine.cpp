#include "server/store/quarantine.h"

#include <sys/stat.h>

#include <ctime>
#include <system_error>
#include <vector>

#include "core/log.h"
#include "server/store/tables/names.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

std::int64_t BytesOf(const fs::path& path) {
  std::error_code error;
  if (fs::is_regular_file(fs::symlink_status(path, error)))
    return static_cast<std::int64_t>(fs::file_size(path, error));
  std::int64_t bytes = 0;
  for (fs::recursive_directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code gone;
    if (entry->is_regular_file(gone) && !entry->is_symlink(gone))
      bytes += static_cast<std::int64_t>(entry->file_size(gone));
  }
  return bytes;
}

/// [s] since an entry was renamed to where it is, or was changed since.
std::int64_t AgeOf(const fs::path& entry) {
  struct stat status {};
  return ::lstat(entry.c_str(), &status) == 0 ? std::time(nullptr) - status.st_ctime : 0;
}

}  // namespace

void Quarantine::Tidy(std::chrono::seconds kept) {
  num_entries_ = 0;
  num_bytes_ = 0;
  std::vector<fs::path> entries;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
    entries.push_back(entry.path());
  for (const fs::path& entry : entries) {
    std::error_code error;
    if (AgeOf(entry) > kept.count() && fs::remove_all(entry, error) > 0 && !error) {
      LogWarning("removed from quarantine name=" + entry.filename().string());
    } else {
      Count(entry);
    }
  }
}

void Quarantine::Take(const fs::path& path, const fs::path& root) {
  const fs::path target = folder_ / (NewId() + "-" + path.filename().string());
  fs::rename(path, target);
  Count(target);
  LogWarning("quarantined path=" + path.lexically_relative(root).string() +
             " as=" + target.filename().string());
}

void Quarantine::Count(const fs::path& entry) {
  ++num_entries_;
  num_bytes_ += BytesOf(entry);
}

}  // namespace parkade
