#pragma once

#include <filesystem>

namespace parkade {

/// A file that holds nothing but room: a full disk could otherwise not even take in the deletion
/// that would free it. One thread at a time.
class Ballast {
 public:
  /// Gives the room up at once where the disk of `file` is full.
  explicit Ballast(std::filesystem::path file);

  /// Gives the room up; false where there was none.
  bool Drop();
  /// Takes the room again, once there is plenty.
  void Restore();

 private:
  std::filesystem::path file_;
};

}  // namespace parkade
