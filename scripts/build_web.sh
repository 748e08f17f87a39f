#!/usr/bin/env bash
# Builds the viewer into web/dist; does nothing when that is newer than its sources.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_node_modules.sh
cd web
sources=(src public index.html package-lock.json vite.config.ts ../server/http/openapi.json)
# src/api/schema.ts is made of the last one.
if [ ! -f dist/index.html ] || [ -n "$(find "${sources[@]}" -newer dist/index.html ! -name schema.ts -print -quit)" ]; then
  npm run --silent build
fi
