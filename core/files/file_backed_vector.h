#pragma once

#include <cstddef>
#include <vector>

namespace parkade {

/// [bytes] from which an array lies in a file without a name, in $TMPDIR or else /var/tmp: the
/// operating system writes it out and reads it again as it needs room, so that it may be larger
/// than memory. Smaller ones lie where all do.
inline constexpr std::size_t kMinScratchBytes = std::size_t{64} << 20;

/// Returns memory that is zero where a file is behind it. Throws std::bad_alloc where neither disk
/// nor memory has room.
void* AllocateScratch(std::size_t num_bytes);
void FreeScratch(void* data, std::size_t num_bytes) noexcept;

/// Takes the pages of `data` out of this program's memory; the system reads them again when they
/// are looked at. Does nothing unless a file is behind `data`. `num_bytes` as allocated.
/// Thread-safe.
void ReleaseScratch(const void* data, std::size_t num_bytes) noexcept;

template <typename Value>
struct FileBackedAllocator {
  using value_type = Value;

  FileBackedAllocator() = default;
  template <typename Other>
  FileBackedAllocator(const FileBackedAllocator<Other>&) {}  // NOLINT: converts

  Value* allocate(std::size_t count) {
    return static_cast<Value*>(AllocateScratch(count * sizeof(Value)));
  }
  void deallocate(Value* data, std::size_t count) noexcept {
    FreeScratch(data, count * sizeof(Value));
  }

  bool operator==(const FileBackedAllocator&) const = default;
};

/// An array that may be larger than memory, for those that are gone through from one end to the
/// other, or square by square.
template <typename Value>
using FileBackedVector = std::vector<Value, FileBackedAllocator<Value>>;

/// Calls ReleaseScratch for the array, between one part of the work and the next.
template <typename Value>
void ReleaseMemory(const FileBackedVector<Value>& values) {
  ReleaseScratch(values.data(), values.capacity() * sizeof(Value));
}

}  // namespace parkade
