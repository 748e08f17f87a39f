#!/usr/bin/env bash
# Runs clang-tidy (.clang-tidy) on sources of the product; fails where it finds something.
#   scripts/tidy.sh            what changed (scripts/changed_files.sh), at most 25 files
#   scripts/tidy.sh --all      everything: about an hour and a half on two cores
#   scripts/tidy.sh FILE ...   these
# TIDY_SECONDS: no file is begun after so many seconds; those left are named, and are no failure.
set -euo pipefail
cd "$(dirname "$0")/.."

product='^(core|slam|mapping|export|server)/.*\.(h|cpp)$'
most=25
case "${1:-}" in
  "") files=$(scripts/changed_files.sh | grep -E "$product" || true) ;;
  --all) files=$(git ls-files | grep -E "$product"); most=1000000 ;;
  -*) echo "usage: $0 [--all | FILE ...]" >&2; exit 2 ;;
  *) files=$(printf '%s\n' "$@"); most=1000000 ;;
esac
# A header is looked at with its source.
sources=$(sed 's/\.h$/.cpp/' <<< "$files" | sort -u | while read -r file; do [ ! -f "$file" ] || echo "$file"; done)
count=$(grep -c . <<< "$sources" || true)
if [ "$count" -eq 0 ]; then echo "tidy: no source changed"; exit 0; fi
if [ "$count" -gt "$most" ]; then
  echo "tidy: $count sources changed; these $most are looked at"
  sources=$(head -n "$most" <<< "$sources")
fi

# One source, one command: neither unity groups nor g++'s precompiled headers are clang's.
mkdir -p build
cmake -S . -B build/tidy -G Ninja -DCMAKE_BUILD_TYPE=Release -DPARKADE_UNITY=OFF \
  -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON > build/tidy.log 2>&1 || { cat build/tidy.log >&2; exit 1; }

tidy=$(command -v clang-tidy-14 || command -v clang-tidy)
end=$(($(date +%s) + ${TIDY_SECONDS:-1000000}))
check() {
  local left=$(($1 - $(date +%s))) file=$2
  if [ "$left" -le 0 ]; then echo "tidy: no time left for $file"; return 0; fi
  # clang knows neither g++'s memory parameters nor all of its warnings.
  nice -n 10 "$3" -p build/tidy --quiet --extra-arg=-Wno-unused-command-line-argument \
    --extra-arg=-Wno-unknown-warning-option "$file" 2> /dev/null
}
export -f check
xargs -d '\n' -P 2 -I{} bash -c 'check "$@"' _ "$end" {} "$tidy" <<< "$sources" ||
  { echo "tidy: findings above" >&2; exit 1; }
echo "tidy: $(grep -c . <<< "$sources") sources"
