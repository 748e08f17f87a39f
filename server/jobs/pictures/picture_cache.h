#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

namespace parkade {

struct PictureCacheLimits {
  std::int64_t bytes = std::int64_t{1} << 30;
  std::int64_t files = 20000;
};

/// Files in a folder, of which those that nobody asked for the longest are deleted where there are
/// too many. Nothing depends on them: they may also be deleted by others. Thread-safe.
class PictureCache {
 public:
  /// Takes over what is there, in the order of last use, but for the folders of drives that
  /// `is_drive` does not know.
  PictureCache(const std::filesystem::path& folder, PictureCacheLimits limits,
               const std::function<bool(const std::string& drive)>& is_drive);

  /// Where the file of this name ("DRIVE/RIG/NAME") lies, or is to be put.
  std::filesystem::path PathOf(const std::string& name) const { return folder_ / name; }

  /// The file's content; it counts as used now. Nothing where there is none.
  std::optional<std::string> Find(const std::string& name);

  /// Counts a file that was put there as used now, and deletes others where that is too much.
  void Add(const std::string& name);

  std::int64_t bytes() const;
  std::int64_t files() const;

 private:
  struct Entry {
    std::string name;
    std::int64_t bytes = 0;
  };
  void Insert(const std::string& name, std::int64_t bytes);
  void Drop(const std::string& name);

  const std::filesystem::path folder_;
  const PictureCacheLimits limits_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  ///< last used first
  std::unordered_map<std::string, std::list<Entry>::iterator> by_name_;
  std::int64_t bytes_ = 0;
};

}  // namespace parkade
