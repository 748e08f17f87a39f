#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/files/sha256.h"

namespace parkade {

/// The hash of what has arrived, as far as it was computed on the way: after a restart it stands at
/// the beginning.
class ArrivedHash {
 public:
  /// `first_byte`: where in their file the bytes begin.
  explicit ArrivedHash(std::int64_t first_byte = 0) : first_byte_(first_byte) {}

  void Add(std::string_view piece);
  /// Reads on until `end` bytes are hashed; false when `is_stopping` becomes true. Throws
  /// Error{kInternal} where the file cannot be read.
  bool CatchUp(const std::filesystem::path& file, std::int64_t end,
               const std::atomic<bool>& is_stopping);

  std::int64_t bytes() const { return bytes_; }
  std::string Finish() { return sha256_.Finish(); }

 private:
  std::int64_t first_byte_;
  Sha256 sha256_;
  std::int64_t bytes_ = 0;
};

}  // namespace parkade
