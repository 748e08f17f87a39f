#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace parkade {

/// What a worker last said about itself.
struct WorkerProgress {
  std::string stage;
  double progress = 0;                     ///< of the whole, 0 to 1, never decreasing
  std::optional<double> eta;               ///< [s] left, where the worker says so
  std::optional<std::string> error, code;  ///< of the worker's last words
};

/// Follows the progress file of a worker (server/jobs/job_spec.h). Lines that are
/// not understood are skipped: a worker that talks nonsense does no harm here.
class ProgressReader {
 public:
  explicit ProgressReader(std::filesystem::path file) : file_(std::move(file)) {}

  /// Reads what was appended since the last call; true when that changed anything.
  bool Poll();

  const WorkerProgress& latest() const { return latest_; }
  const std::filesystem::path& file() const { return file_; }

 private:
  bool Take(const std::string& line);

  std::filesystem::path file_;
  std::int64_t offset_ = 0;
  std::string partial_line_;
  WorkerProgress latest_;
};

}  // namespace parkade
