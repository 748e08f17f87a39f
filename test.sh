#!/usr/bin/env bash
# Installs what is missing, builds, runs all tests. What CI runs.
#   ./test.sh          everything
#   ./test.sh --fast   without the sanitizer builds
set -euo pipefail
cd "$(dirname "$0")"

fast=false
case "${1:-}" in
  "") ;;
  --fast) fast=true ;;
  *) echo "usage: $0 [--fast]" >&2; exit 2 ;;
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

if ! $fast; then
  # OpenCV's and TBB's own threads give false reports under TSan: the server core has none.
  say "ASan and UBSan on the units"
  cmake --preset asan
  cmake --build --preset asan --target parkade_unit_tests
  ctest --test-dir build/asan --output-on-failure --parallel 2 -L '^(unit|server_core)$'

  say "TSan on the server core"
  cmake --preset tsan
  cmake --build --preset tsan --target parkade_server_core_tests
  ctest --test-dir build/tsan --output-on-failure --parallel 2 -L '^server_core$'
fi

say "all tests passed"
