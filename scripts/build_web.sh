#!/usr/bin/env bash
# Builds the viewer into web/dist; does nothing when that is newer than its sources.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_node_modules.sh
cd web
if [ ! -f dist/index.html ] || [ -n "$(find src public index.html package-lock.json vite.config.ts -newer dist/index.html -print -quit)" ]; then
  npm run --silent build
fi
