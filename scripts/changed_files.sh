#!/usr/bin/env bash
# Prints the files that changed, committed or not, since this branch left its upstream.
#   scripts/changed_files.sh [PATTERN ...]
# Upstream is the branch that this one follows, else origin/main. Without either, or where nothing
# changed since, it is the commit before the last.
set -euo pipefail
cd "$(dirname "$0")/.."

upstream=$(git rev-parse --verify --quiet '@{upstream}' || git rev-parse --verify --quiet origin/main || true)
base=""
if [ -n "$upstream" ]; then base=$(git merge-base HEAD "$upstream"); fi
if [ -z "$base" ] || git diff --quiet "$base" --; then
  base=$(git rev-parse --verify --quiet HEAD~1 || git hash-object -t tree /dev/null)
fi
git diff --name-only --diff-filter=d "$base" -- "$@"
