#pragma once

#include <cstddef>

#define PARKADE_INLINE __attribute__((always_inline)) inline
#define PARKADE_INLINE_CALL __attribute__((always_inline))  // of a lambda
#if defined(__x86_64__)
#define PARKADE_FOR_AVX2 __attribute__((target("avx2,fma")))
#else
#define PARKADE_FOR_AVX2
#endif

namespace parkade {

/// Floats of channels lie together in groups, which are whole vectors on every processor.
constexpr std::size_t kGroup = 8;

/// `count` rounded up to whole groups.
constexpr std::size_t RoundUpToGroup(std::size_t count) {
  return (count + kGroup - 1) / kGroup * kGroup;
}

// By reference: how vectors are passed by value depends on the processor.

/// Vectors of SSE and of NEON.
struct NarrowVectors {
  using Floats = float __attribute__((vector_size(16)));
  /// Anywhere among floats.
  struct __attribute__((packed, may_alias)) InMemory {
    Floats values;
  };
  static constexpr std::size_t kLength = 4;

  PARKADE_INLINE static const InMemory& At(const float* from) {
    return *reinterpret_cast<const InMemory*>(from);
  }
  PARKADE_INLINE static void Store(const Floats& values, float* to) {
    reinterpret_cast<InMemory*>(to)->values = values;
  }
};

/// Vectors of AVX.
struct WideVectors {
  using Floats = float __attribute__((vector_size(32)));
  /// Anywhere among floats.
  struct __attribute__((packed, may_alias)) InMemory {
    Floats values;
  };
  static constexpr std::size_t kLength = 8;

  PARKADE_INLINE static const InMemory& At(const float* from) {
    return *reinterpret_cast<const InMemory*>(from);
  }
  PARKADE_INLINE static void Store(const Floats& values, float* to) {
    reinterpret_cast<InMemory*>(to)->values = values;
  }
};

template <typename Kernel>
PARKADE_FOR_AVX2 void RunWithAvx2(const Kernel& kernel) {
  kernel(WideVectors{});
}

/// Calls `kernel(Vectors{})` with the widest that this processor has, compiled for it. The kernel
/// and what it calls must be inline: PARKADE_INLINE, PARKADE_INLINE_CALL.
template <typename Kernel>
void RunInVectors(const Kernel& kernel) {
#if defined(__x86_64__)
  static const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (has_avx2) return RunWithAvx2(kernel);
#endif
  kernel(NarrowVectors{});
}

}  // namespace parkade
