#pragma once

namespace parkade {

/// ThreadSanitizer keeps a thread of its own in every process.
#if defined(__SANITIZE_THREAD__)
inline constexpr bool kHasThreadSanitizer = true;
#else
inline constexpr bool kHasThreadSanitizer = false;
#endif

/// Sanitizers have an allocator of their own, which keeps what was let go, and take several times
/// as long: no measure of memory or time holds.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kHasSanitizer = true;
#else
inline constexpr bool kHasSanitizer = kHasThreadSanitizer;
#endif

}  // namespace parkade
