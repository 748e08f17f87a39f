#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>

namespace parkade {

/// The folder for what was found without a row in the database: it may be somebody's only copy, and
/// is kept for a month. Thread-safe.
class Quarantine {
 public:
  static constexpr std::chrono::hours kKept{30 * 24};

  explicit Quarantine(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Removes what was put there more than `kept` ago, with a line in the log for each, and counts
  /// the rest. Call at the start.
  void Tidy(std::chrono::seconds kept = kKept);

  /// Moves `path` there; the log names it relative to `root`.
  void Take(const std::filesystem::path& path, const std::filesystem::path& root);

  std::int64_t num_entries() const { return num_entries_; }
  std::int64_t num_bytes() const { return num_bytes_; }

 private:
  void Count(const std::filesystem::path& entry);

  std::filesystem::path folder_;
  std::atomic<std::int64_t> num_entries_ = 0, num_bytes_ = 0;
};

}  // namespace parkade
