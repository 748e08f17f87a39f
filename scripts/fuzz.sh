#!/usr/bin/env bash
# Feeds damaged logs to the readers for some time (libFuzzer, ASan); fails on a crash, a leak or a hang.
#   scripts/fuzz.sh [SECONDS]    default: 60
# Begins with the small logs that the tests have made in build/release, and with what earlier runs
# found (build/fuzz/corpus). An input that fails stays in build/fuzz.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${1:-60}
folder=build/fuzz
mkdir -p "$folder/corpus"
cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="-O1 -g1" \
  -DCMAKE_CXX_COMPILER=clang++-14 -DPARKADE_FUZZ=ON -DPARKADE_SANITIZE=fuzzer-no-link,address \
  > "$folder/configure.log" 2>&1 || { cat "$folder/configure.log" >&2; exit 1; }
cmake --build "$folder" --target parkade_log_fuzzer

seeds=build/release/tests/server/ingest/containers/samples
if [ -d "$seeds" ]; then
  find "$seeds" -type f -size -1000k \( -name '*.bag' -o -name '*.mcap' -o -name '*.db3' -o -name '*.zstd' \) \
    -exec cp -n {} "$folder/corpus" \;
fi
echo "fuzz: $(find "$folder/corpus" -type f | wc -l) logs to begin with"
"$folder/tests/server/ingest/containers/parkade_log_fuzzer" -max_total_time="$seconds" -max_len=1000000 -timeout=10 \
  -rss_limit_mb=2000 -print_final_stats=1 -verbosity=0 -artifact_prefix="$folder/" "$folder/corpus"
