#!/usr/bin/env bash
# Installs what is missing, builds, runs all tests. What CI runs.
#   ./test.sh                    everything; sanitizers and clang-tidy look at what changed since
#                                the upstream (scripts/changed_files.sh): the test programs of the
#                                folders with a change, four minutes of clang-tidy. At most 45
#                                minutes on two slow cores.
#   ./test.sh --all-sanitizers   the same with ASan and UBSan on all test programs, TSan on the
#                                server core
#   ./test.sh --fast             format, build and tests: no sanitizers, clang-tidy or fuzzer
set -euo pipefail
cd "$(dirname "$0")"

mode=changed
case "${1:-}" in
  "") ;;
  --fast) mode=fast ;;
  --all-sanitizers) mode=all ;;
  *) echo "usage: $0 [--fast | --all-sanitizers]" >&2; exit 2 ;;
esac

say() { printf '\n== %s (%s s)\n' "$*" "$SECONDS"; }

say "packages"
scripts/install_packages.sh
scripts/install_node_modules.sh

say "format"
git ls-files '*.h' '*.cpp' | xargs clang-format --dry-run --Werror

say "build"
cmake --preset release
cmake --build --preset release

say "web page"
scripts/build_web.sh
npm --prefix web test

say "tests"
ctest --test-dir build/release --output-on-failure --parallel 2
# A suite passes with cases skipped: which, and why.
grep -B 1 -h '^\[  SKIPPED \] .* ms)$' build/release/Testing/Temporary/LastTest.log || echo "no case was skipped"

changes=$(scripts/changed_files.sh)
# True where sanitizers are to look at the folders of this pattern.
wants() { [ "$mode" = all ] || grep -qE "^($1)/" <<< "$changes"; }

# Where everything changed, sanitizers would take a slow machine an hour: none is begun after thirty
# minutes. What is left out is said.
is_late() { [ "$mode" = changed ] && [ "$SECONDS" -gt 1800 ]; }

# Suites of whole drives and surfaces take a sanitizer 5 to 24 minutes each.
left_out=()
if [ "$mode" = changed ]; then left_out=(--exclude-regex '^(TrajectoryEstimator|SelfCalibration|Seeds/DriveWithSeed|FuseSurface|EvaluateSurface|MapHardScene|DeformMesh)$'); fi

# Builds test programs under a sanitizer's preset, one after the other, and runs their suites, which
# have their labels.
sanitize() {
  local preset=$1 program
  shift
  cmake --preset "$preset"
  for program in "$@"; do
    if is_late; then say "no time for $program under $preset: ./test.sh --all-sanitizers"; continue; fi
    say "$program under $preset"
    cmake --build --preset "$preset" --target "$program"
    ctest --test-dir "build/$preset" --output-on-failure --parallel 2 --no-tests=error -L "^$program\$" "${left_out[@]}"
  done
}

if [ "$mode" != fast ]; then
  server_core=(parkade_server_store_tests parkade_server_jobs_tests parkade_server_http_tests)
  # OpenCV's and TBB's own threads give false reports under TSan: the server core has none.
  if wants 'core|server/(store|jobs|http)|tests/server/(store|jobs|http)'; then sanitize tsan "${server_core[@]}"; fi
  programs=()
  if wants 'core|tests/core'; then programs+=(parkade_core_tests); fi
  if wants 'export|tests/export'; then programs+=(parkade_export_tests); fi
  if wants 'server/ingest|tests/server/ingest'; then
    programs+=(parkade_server_ingest_tests parkade_server_ingest_containers_tests)
  fi
  if wants 'server/(store|jobs|http)|tests/server/(store|jobs|http)'; then programs+=("${server_core[@]}"); fi
  if wants 'slam|tests/slam|tests/support'; then programs+=(parkade_slam_tests); fi
  if wants 'mapping|tests/mapping'; then programs+=(parkade_mapping_tests); fi
  if [ ${#programs[@]} -gt 0 ]; then sanitize asan "${programs[@]}"; fi

  say "fuzzers"
  scripts/fuzz.sh --seconds 30 log
  scripts/fuzz.sh --seconds 5 bag mcap cdr rig head range tus json

  say "clang-tidy"
  TIDY_SECONDS=240 scripts/tidy.sh
fi

say "all tests passed"
