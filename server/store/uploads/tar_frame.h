#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace parkade {

class GrowingFile;

/// A tar without the contents of its files: whoever has one writes it to its place. Equal files in
/// equal order make equal bytes: times are 0, owners none, modes 0644.
class TarFrame {
 public:
  struct File {
    std::string path;  ///< printable ASCII, relative
    std::int64_t bytes = 0;
  };
  explicit TarFrame(const std::vector<File>& files);

  /// [byte] where the content of a file begins.
  std::int64_t FirstByteOf(size_t file) const { return first_bytes_[file]; }
  /// [bytes] of the whole tar.
  std::int64_t bytes() const;

  /// Writes it to an empty file; what is left for contents is zeros.
  void Write(GrowingFile& file) const;

 private:
  std::vector<std::string> headers_;
  std::vector<std::int64_t> first_bytes_;
  std::int64_t end_ = 0;  ///< [byte] behind the last file
};

}  // namespace parkade
