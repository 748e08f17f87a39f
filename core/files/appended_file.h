#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace parkade {

/// A descriptor of a file without a name, in $TMPDIR or else /var/tmp, which is gone once it is
/// closed; -1 where that folder takes none.
int OpenNamelessFile();

/// A file that grows at its end and is read anywhere. Bounded memory: what is appended is collected
/// to writes of kBufferBytes. Throws Error{kDiskFull} where there is no space, Error{kInternal}
/// otherwise.
class AppendedFile {
 public:
  static constexpr std::size_t kBufferBytes = std::size_t{1} << 18;

  /// Makes a file without a name (OpenNamelessFile); its bytes stay in memory where there is no
  /// such file, and as long as nothing was written.
  AppendedFile() = default;
  /// Creates `path`, which must not exist. It stays; Flush() before anybody else reads it.
  explicit AppendedFile(const std::filesystem::path& path);
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;

  void Append(std::string_view bytes);
  /// Replaces some of the bytes that were appended.
  void Overwrite(std::uint64_t offset, std::string_view bytes);
  void Flush();

  /// Reads what was appended. Several threads may read at once, while none writes.
  std::string Read(std::uint64_t offset, std::size_t size) const;

  std::uint64_t size() const { return written_ + pending_.size(); }

 private:
  void Write(std::uint64_t offset, std::string_view bytes);

  std::string name_ = "a scratch file in $TMPDIR or /var/tmp";  ///< for messages
  int file_ = -1;
  std::uint64_t written_ = 0;
  std::string pending_;
};

}  // namespace parkade
