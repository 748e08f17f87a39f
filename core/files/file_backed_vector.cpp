#include "core/files/file_backed_vector.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <new>

#include "core/files/appended_file.h"

namespace parkade {
namespace {

/// To take more than there is would fill the disk for everybody else before it fails.
bool HasRoomFor(int file, std::size_t num_bytes) {
  struct statvfs disk {};
  return ::fstatvfs(file, &disk) == 0 && num_bytes / disk.f_frsize < disk.f_bavail;
}

/// A file of this length that nobody else sees, or -1. Its room is taken right away: to find the
/// disk full while a page is written would end the program.
int OpenFileOf(std::size_t num_bytes) {
  const int file = OpenNamelessFile();
  if (file < 0) return -1;
  if (HasRoomFor(file, num_bytes) && ::posix_fallocate(file, 0, static_cast<off_t>(num_bytes)) == 0)
    return file;
  ::close(file);
  return -1;
}

/// No folder has room: memory may.
int OpenMemory(std::size_t num_bytes) {
  const int file = ::memfd_create("parkade", MFD_CLOEXEC);
  if (file < 0) return -1;
  if (::ftruncate(file, static_cast<off_t>(num_bytes)) == 0) return file;
  ::close(file);
  return -1;
}

}  // namespace

void* AllocateScratch(std::size_t num_bytes) {
  if (num_bytes < kMinScratchBytes) return ::operator new(num_bytes);
  int file = OpenFileOf(num_bytes);
  if (file < 0) file = OpenMemory(num_bytes);
  if (file < 0) throw std::bad_alloc();
  void* data = ::mmap(nullptr, num_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  if (data == MAP_FAILED) throw std::bad_alloc();
  return data;
}

void FreeScratch(void* data, std::size_t num_bytes) noexcept {
  if (num_bytes < kMinScratchBytes)
    ::operator delete(data);
  else
    ::munmap(data, num_bytes);
}

void ReleaseScratch(const void* data, std::size_t num_bytes) noexcept {
  // Pages of a shared file keep what was written to them.
  if (num_bytes >= kMinScratchBytes) ::madvise(const_cast<void*>(data), num_bytes, MADV_DONTNEED);
}

}  // namespace parkade
