#include "server/jobs/pictures/picture_cache.h"

#include <algorithm>
#include <vector>

#include "core/error.h"
#include "server/store/disk/workers_files.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;  // of a picture, or of an index

struct Found {
  fs::file_time_type used;
  std::string name;
  std::int64_t bytes = 0;
};

/// All files below a folder, the last used last.
std::vector<Found> FilesBelow(const fs::path& folder) {
  std::vector<Found> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (fs::is_regular_file(entry.symlink_status()))
      files.push_back({entry.last_write_time(), entry.path().lexically_relative(folder).string(),
                       static_cast<std::int64_t>(entry.file_size())});
  std::sort(files.begin(), files.end(), [](const Found& a, const Found& b) {
    return std::tie(a.used, a.name) < std::tie(b.used, b.name);
  });
  return files;
}

}  // namespace

PictureCache::PictureCache(const fs::path& folder, PictureCacheLimits limits,
                           const std::function<bool(const std::string& drive)>& is_drive)
    : folder_(folder), limits_(limits) {
  std::vector<fs::path> strangers;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
    if (!is_drive(entry.path().filename().string())) strangers.push_back(entry.path());
  for (const fs::path& stranger : strangers) fs::remove_all(stranger);
  for (const Found& file : FilesBelow(folder_)) Insert(file.name, file.bytes);
}

std::optional<std::string> PictureCache::Find(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto found = by_name_.find(name);
  if (found == by_name_.end()) return std::nullopt;
  try {
    std::string content = ReadWorkersFile(PathOf(name), kMaxBytes);
    entries_.splice(entries_.begin(), entries_, found->second);
    std::error_code ignored;  // the order of use after the next start is a matter of taste
    fs::last_write_time(PathOf(name), fs::file_time_type::clock::now(), ignored);
    return content;
  } catch (const Error&) {  // others have deleted it
    Drop(name);
    return std::nullopt;
  }
}

void PictureCache::Add(const std::string& name) {
  std::error_code gone;
  const auto bytes = fs::file_size(PathOf(name), gone);
  const std::lock_guard lock(mutex_);
  Drop(name);
  if (!gone) Insert(name, static_cast<std::int64_t>(bytes));
}

std::int64_t PictureCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

std::int64_t PictureCache::files() const {
  const std::lock_guard lock(mutex_);
  return std::ssize(entries_);
}

void PictureCache::Insert(const std::string& name, std::int64_t bytes) {
  entries_.push_front({name, bytes});
  by_name_[name] = entries_.begin();
  bytes_ += bytes;
  while (entries_.size() > 1 && (bytes_ > limits_.bytes || std::ssize(entries_) > limits_.files)) {
    const std::string last = entries_.back().name;
    std::error_code ignored;
    fs::remove(PathOf(last), ignored);
    Drop(last);
  }
}

void PictureCache::Drop(const std::string& name) {
  const auto found = by_name_.find(name);
  if (found == by_name_.end()) return;
  bytes_ -= found->second->bytes;
  entries_.erase(found->second);
  by_name_.erase(found);
}

}  // namespace parkade
