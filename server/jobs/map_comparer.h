#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/store/data_directory.h"

namespace parkade {

/// The command line that compares two finished maps and leaves changes.json, changes.geojson,
/// changes.png and changes.pgw in the folder `out`, which it makes, or nothing. When it fails with
/// status 1, the last line that it prints is a sentence for the user.
using CompareCommand = std::function<std::vector<std::string>(const std::filesystem::path& from,
                                                              const std::filesystem::path& to,
                                                              const std::filesystem::path& out)>;

/// Compares published maps, each pair in a process of its own and once: the result is kept in tmp/
/// until the service starts again. One comparison at a time. Thread-safe.
class MapComparer {
 public:
  /// Borrows the directory.
  MapComparer(const DataDirectory& directory, CompareCommand command);

  /// The folder with the files of a comparison. Waits where another is under way; nothing where too
  /// many wait already. Throws Error{kInvalidInput} for maps that cannot be compared,
  /// Error{kInternal} otherwise; nothing is kept then, and the next caller tries again.
  std::optional<std::filesystem::path> Compare(const std::string& from_map,
                                               const std::string& to_map);

  /// Ends the comparison under way. Final.
  void Stop() { is_stopping_ = true; }

 private:
  void Run(const std::string& from_map, const std::string& to_map,
           const std::filesystem::path& out) const;

  const DataDirectory& directory_;
  CompareCommand command_;
  std::mutex one_at_a_time_;
  std::atomic<int> num_callers_ = 0;
  std::atomic<bool> is_stopping_ = false;
};

}  // namespace parkade
