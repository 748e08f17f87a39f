#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "server/map_folder/stage_cache.h"

namespace parkade {

/// A stage's product, with the key of all that it depends on: its inputs' keys and its options. A
/// stage that takes it hashes the key into its own.
template <typename Value>
struct Keyed {
  Value value;
  std::string key;
};

/// How a stage's product lies in a map's folder.
template <typename Value>
struct StageFile {
  std::string name;  ///< relative to the folder
  std::function<std::string(const Value&)> encode;
  std::function<Value(std::string_view)> decode;
};

/// The product under `key`, taken from the cache or computed by `compute`, and kept. Both ways give
/// the same bits: what was computed is decoded, too. A product that was taken took no seconds.
template <typename Value, typename Compute>
Keyed<Value> Cached(const StageCache& cache, const StageFile<Value>& file, std::string key,
                    Compute compute) {
  constexpr bool kHasSeconds = requires(Value value) { value.seconds; };
  double seconds = 0;
  const std::string bytes = cache.Get(file.name, key, [&] {
    const Value computed = compute();
    if constexpr (kHasSeconds) seconds = computed.seconds;
    return file.encode(computed);
  });
  Value value = file.decode(bytes);
  if constexpr (kHasSeconds) value.seconds = seconds;
  return {std::move(value), std::move(key)};
}

}  // namespace parkade
