#pragma once

#include <cstddef>
#include <functional>
#include <type_traits>
#include <vector>

namespace parkade {

/// Threads used by ParallelFor, the caller's included; default: all cores. Call
/// before the first ParallelFor.
void SetNumThreads(int num_threads);
int NumThreads();

/// Keeps OpenBLAS, where it is what linear algebra runs on, to the thread that calls it. With
/// threads of its own it would take more than SetNumThreads allows, wait for them by spinning, and
/// round differently on other machines.
void KeepLinearAlgebraToCaller();

/// Calls `body(i)` once for every i in [0, count), on up to NumThreads() threads.
/// Returns when all are done. The first exception by index is rethrown. Loops
/// inside `body` are safe: threads that have nothing else to do help with them.
void ParallelFor(std::size_t count, const std::function<void(std::size_t)>& body);

/// Results of `body(i)` in index order, whatever the order of execution.
template <typename Body>
auto ParallelMap(std::size_t count, const Body& body) {
  std::vector<std::invoke_result_t<Body, std::size_t>> results(count);
  ParallelFor(count, [&](std::size_t i) { results[i] = body(i); });
  return results;
}

}  // namespace parkade
