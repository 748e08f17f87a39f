#include "core/files/file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <fstream>
#include <system_error>

#include "core/error.h"
#include "core/files/appended_file.h"

namespace parkade {
namespace {

/// Removes the temporary file unless it was renamed away.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target) {
    static std::atomic<unsigned> counter{0};
    path_ = target;
    path_ += ".tmp." + std::to_string(::getpid()) + "." + std::to_string(counter++);
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void Sync(const std::filesystem::path& path, int flags) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC);
  if (fd < 0) ThrowErrno("cannot open '" + path.filename().string() + "'", errno);
  const int result = ::fsync(fd);
  const int error = errno;
  ::close(fd);
  if (result != 0) ThrowErrno("cannot write '" + path.filename().string() + "' to disk", error);
}

}  // namespace

void CopyToWrite(const std::filesystem::path& from, const std::filesystem::path& to) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) ThrowCannotWrite(to);
  fs::permissions(to, fs::perms::owner_write, fs::perm_options::add);
}

void WriteFileAtomically(const std::filesystem::path& file,
                         const std::function<void(const std::filesystem::path&)>& write) {
  const TemporaryFile temporary(file);
  write(temporary.path());
  Sync(temporary.path(), O_RDONLY);
  if (::rename(temporary.path().c_str(), file.c_str()) != 0)
    ThrowErrno("cannot write '" + file.filename().string() + "'", errno);
  Sync(file.has_parent_path() ? file.parent_path() : ".", O_RDONLY | O_DIRECTORY);
}

void WriteFileAtomically(const std::filesystem::path& file, std::string_view content) {
  WriteFileAtomically(file, [&](const std::filesystem::path& temporary) {
    AppendedFile written(temporary);
    written.Append(content);
    written.Flush();
  });
}

bool IsFile(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

std::string ReadFile(const std::filesystem::path& file, std::size_t max_bytes) {
  std::error_code ignored;
  Require(!std::filesystem::is_directory(file, ignored), ErrorCode::kInvalidInput,
          "'" + file.string() +
              "' is a folder, not a file");  // one opens, and claims to be larger than any file
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  Require(stream.good(), ErrorCode::kNotFound, "cannot read '" + file.string() + "'");
  const auto size = static_cast<std::size_t>(stream.tellg());
  Require(size <= max_bytes, ErrorCode::kInvalidInput, "'" + file.string() + "' is too large");
  std::string content(size, '\0');
  stream.seekg(0);
  stream.read(content.data(), static_cast<std::streamsize>(size));
  Require(stream.good() || size == 0, ErrorCode::kInvalidInput,
          "cannot read '" + file.string() + "' to its end");
  return content;
}

}  // namespace parkade
