#include "core/tune_malloc.h"

#include <cstdlib>  // where __GLIBC__ comes from

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace parkade {

void TuneMalloc() {
#ifdef __GLIBC__
  constexpr int kLargest =
      32 << 20;  // bytes of a piece, as much as glibc allows: larger ones are given back
  constexpr int kMostIdle = 256 << 20;  // bytes at the end of the heap
  ::mallopt(M_MMAP_THRESHOLD, kLargest);
  ::mallopt(M_TRIM_THRESHOLD, kMostIdle);
#endif
}

void ReleaseIdleMemory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

}  // namespace parkade
