#pragma once

#include <cstdint>
#include <filesystem>

namespace parkade {

/// Keeps a log that another process appends to (O_APPEND) from growing without end: of a longer one
/// the beginning and the end stay, and a line between them says that something is missing. The
/// writer never waits for it and notices nothing; what it writes in the very moment of a cut may be
/// lost.
class LogLimit {
 public:
  static constexpr std::int64_t kHead = std::int64_t{4} << 20;   ///< [bytes] of the beginning
  static constexpr std::int64_t kTail = std::int64_t{6} << 20;   ///< [bytes] of the end after a cut
  static constexpr std::int64_t kMost = std::int64_t{16} << 20;  ///< [bytes] from which it is cut

  explicit LogLimit(std::filesystem::path file) : file_(std::move(file)) {}

  /// Cuts the log where it has grown too long. Call several times a second.
  void Apply();

 private:
  std::filesystem::path file_;
  std::int64_t left_out_ = 0;  ///< [bytes] so far
};

}  // namespace parkade
