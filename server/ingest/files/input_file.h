#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace parkade {

/// A file open for reading at any place. Thread-safe: immutable.
class InputFile {
 public:
  /// Throws Error{kNotFound} when there is no such file or it cannot be read.
  explicit InputFile(const std::filesystem::path& file);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& name() const { return name_; }  ///< without its folder
  std::uint64_t size() const { return size_; }       ///< [byte] when it was opened

  /// Fills `out` from byte `offset` on; the count read, less than asked only at the end of the
  /// file. Throws Error{kInvalidInput} when the disk cannot read.
  std::size_t ReadAt(std::uint64_t offset, std::span<std::uint8_t> out) const;

 private:
  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace parkade
