#pragma once

/// Before a function whose loops the compiler turns into vectors: it is compiled for processors
/// with AVX2, too, and the right version is chosen when the program starts. For integers: with
/// floats the versions may round differently.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PARKADE_VECTORIZED __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define PARKADE_VECTORIZED
#endif

/// The same for floats: without fused multiplications both versions round alike, as long as no sum
/// runs along a loop.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PARKADE_VECTORIZED_FLOATS __attribute__((target_clones("avx2", "default")))
#else
#define PARKADE_VECTORIZED_FLOATS
#endif
