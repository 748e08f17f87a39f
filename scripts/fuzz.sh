#!/usr/bin/env bash
# Feeds what comes from outside with damaged bytes (libFuzzer, ASan); fails on a crash, a leak or a hang.
#   scripts/fuzz.sh [--seconds S] [--runs N] [NAME...]   for each fuzzer: default 60 s, at most N runs
# Fuzzers (tests/fuzz): log (any kind), bag, mcap; cdr (messages), schemas, video, rig; head, range, tus, json (requests).
# Begins with small logs and requests, and with what earlier runs found (build/fuzz/corpus/NAME). An
# input that fails stays in build/fuzz.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=60 runs=-1 names=()
while [ $# -gt 0 ]; do
  case "$1" in
    --seconds) seconds=$2; shift ;;
    --runs) runs=$2; shift ;;
    *) names+=("$1") ;;
  esac
  shift
done
if [ ${#names[@]} -eq 0 ]; then names=(log bag mcap cdr schemas rig video head range tus json); fi

folder=build/fuzz
mkdir -p "$folder"
# The library's own assertions see an empty optional, or an index out of range, where memory is sound.
cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="-O1 -g1 -D_GLIBCXX_ASSERTIONS" \
  -DCMAKE_CXX_COMPILER=clang++-14 -DPARKADE_FUZZ=ON -DPARKADE_SANITIZE=fuzzer-no-link,address \
  > "$folder/configure.log" 2>&1 || { cat "$folder/configure.log" >&2; exit 1; }
cmake --build "$folder" --target parkade_fuzz_seeds "${names[@]/#/parkade_fuzz_}"

# What a fuzzer begins with: small files of the tests, and a word where there is none.
seed() {
  local corpus=$folder/corpus/$1
  mkdir -p "$corpus"
  case "$1" in
    log | bag | mcap) "$folder/tests/fuzz/parkade_fuzz_seeds" "$corpus" ;;
    head) printf 'GET /api/v1/drives?a=b HTTP/1.1\r\nHost: h\r\nContent-Length: 0\r\n\r\n' > "$corpus/seed" ;;
    range) printf 'bytes=0-99' > "$corpus/seed" ;;
    tus) printf 'filename YS5iYWc=,site bG90' > "$corpus/seed" ;;
    json) printf '{"a": ["b", 1.5, null], "b": true, "point": [1, 2, 3]}' > "$corpus/seed" ;;
    schemas)
      printf '\0\24\0float64 x\nstring[] y\0\1\0\0\0\0\0\0\0\0\0\0\1\0\0\0\2\0\0\0a\0' > "$corpus/msg"
      printf '\0\75\0module p { struct T { sequence<double> x; wstring<8> y; }; };\0\1\0\0\1\0\0\0\0\0\0\0' > "$corpus/idl"
      printf '\1\12\0float64 x\n\0\0\0\0\0\0\0\0' > "$corpus/msg1"
      printf '\2\33\0\n\31\n\1t\22\1p\42\21\n\1T\22\14\n\4data\30\1\40\1\50\1\11\0\0\0\0\0\0\360\77' > "$corpus/proto"
      printf '\3\0\0{"timestamp": {"sec": 1}, "data": "AA==", "K": [1], "transforms": [{}], "velocity": [1], "name": ["a"]}' > "$corpus/json" ;;
    rig) cp tests/fuzz/rig.yaml "$corpus/seed" ;;
    *) printf '\0\1\0\0' > "$corpus/seed" ;;
  esac
}

for name in "${names[@]}"; do
  seed "$name"
  echo "fuzz: $name, $(find "$folder/corpus/$name" -type f | wc -l) inputs to begin with"
  "$folder/tests/fuzz/parkade_fuzz_$name" -max_total_time="$seconds" -runs="$runs" -max_len=1000000 -timeout=10 \
    -rss_limit_mb=2000 -print_final_stats=1 -verbosity=0 -artifact_prefix="$folder/$name-" "$folder/corpus/$name"
done
