#include "core/files/appended_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstdlib>

#include "core/error.h"
#include "core/files/file_error.h"

namespace parkade {

int OpenNamelessFile() {
  const char* set = std::getenv("TMPDIR");
  const std::string folder = set != nullptr && *set != '\0' ? set : "/var/tmp";
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0) return file;
  std::string name = folder + "/parkade-XXXXXX";  // not every file system has files without names
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

AppendedFile::AppendedFile(const std::filesystem::path& path)
    : name_("'" + path.filename().string() + "'"),
      file_(::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644)) {
  if (file_ < 0) ThrowErrno("cannot create " + name_, errno);
}

AppendedFile::~AppendedFile() {
  if (file_ >= 0) ::close(file_);
}

void AppendedFile::Append(std::string_view bytes) {
  if (pending_.size() + bytes.size() > kBufferBytes) Flush();
  if (bytes.size() <= kBufferBytes) {
    pending_ += bytes;
  } else {
    Write(written_, bytes);
    written_ += bytes.size();
  }
}

void AppendedFile::Overwrite(std::uint64_t offset, std::string_view bytes) {
  assert(offset + bytes.size() <= size());
  Flush();
  Write(offset, bytes);
}

void AppendedFile::Flush() {
  if (pending_.empty()) return;
  Write(written_, pending_);
  written_ += pending_.size();
  pending_.clear();
}

void AppendedFile::Write(std::uint64_t offset, std::string_view bytes) {
  if (file_ < 0) file_ = OpenNamelessFile();
  if (file_ < 0) file_ = ::memfd_create("parkade", MFD_CLOEXEC);
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) ThrowErrno("cannot write " + name_, errno);
    offset += static_cast<std::uint64_t>(written);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

std::string AppendedFile::Read(std::uint64_t offset, std::size_t size) const {
  assert(offset + size <= this->size());
  std::string bytes(size, '\0');
  const std::size_t num_written =
      offset < written_ ? std::min<std::uint64_t>(size, written_ - offset) : 0;
  for (std::size_t done = 0; done < num_written;) {
    const ssize_t got =
        ::pread(file_, bytes.data() + done, num_written - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) ThrowErrno("cannot read " + name_, errno);
    Require(got > 0, ErrorCode::kInternal, "somebody cut " + name_ + " short");
    done += static_cast<std::size_t>(got);
  }
  if (num_written < size)
    pending_.copy(bytes.data() + num_written, size - num_written, offset + num_written - written_);
  return bytes;
}

}  // namespace parkade
