#!/usr/bin/env bash
# From nothing to a map of a recorded drive, through the service.
#   ./demo.sh          leaves the service running; Ctrl-C ends it
#   ./demo.sh --once   stops it at the end; exits non-zero unless a valid map was served
set -euo pipefail
cd "$(dirname "$0")"

once=false
case "${1:-}" in
  "") ;;
  --once) once=true ;;
  *) echo "usage: $0 [--once]" >&2; exit 2 ;;
esac

say() { printf '\n== %s\n' "$*"; }

say "packages"
scripts/install_packages.sh --build

# The web page comes from the network, the programs keep the processors busy.
mkdir -p demo-data
scripts/build_web.sh > demo-data/web.log 2>&1 &
web=$!

say "build"
[ -f build/release/build.ninja ] || cmake --preset release > build.log 2>&1 || { cat build.log; exit 1; }
rm -f build.log
cmake --build --preset release --target parkade parkade-simulate
parkade=build/release/server/parkade

say "web page"
wait "$web" || { cat demo-data/web.log >&2; exit 1; }

# The drive is kept: the same options give the same bytes.
drive=demo-data/lot.mcap
options=(lot --seed 1 --duration 24 --rate 5)
if [ ! -f "$drive" ] || [ "$(cat demo-data/options 2> /dev/null)" != "${options[*]}" ]; then
  say "a drive: parkade-simulate ${options[*]}"
  rm -rf "$drive" demo-data/rig demo-data/truth demo-data/options
  build/release/tests/simulator/parkade-simulate "${options[@]}" --out "$drive" --rig-out demo-data/rig --truth-out demo-data/truth
  printf '%s' "${options[*]}" > demo-data/options
fi
ls -l "$drive"

say "service"
log=demo-data/serve.log
"$parkade" serve 2> "$log" &
service=$!
trap 'kill "$service" 2> /dev/null || true; wait "$service" 2> /dev/null || true' EXIT
address=http://127.0.0.1:8080
for _ in $(seq 100); do
  curl -fs "$address/readyz" > /dev/null && break
  kill -0 "$service" 2> /dev/null || { cat "$log"; exit 1; }
  sleep 0.1
done
curl -fsS "$address/readyz" > /dev/null

get() { curl -fsS "$address$1"; }
# field NAME... : a value of the JSON on standard input
field() { python3 -c 'import json,sys
value = json.load(sys.stdin)
for key in sys.argv[1:]: value = value[key] if isinstance(value, dict) else value[int(key)]
print("" if value is None else value)' "$@"; }

say "upload"
parts=()
for file in demo-data/rig/*; do parts+=(-F "$(basename "$file")=@$file"); done
curl -fsS -X PUT "$address/api/v1/rigs/demo" -o /dev/null "${parts[@]}"
answer=$(curl -fS -T "$drive" "$address/api/v1/drives?filename=lot.mcap&site=demo&rig=demo")
job=$(field job id <<< "$answer")

say "map"
while :; do
  status=$(get "/api/v1/jobs/$job")
  state=$(field state <<< "$status")
  printf '\r%-12s %-24s %3.0f %%  ' "$state" "$(field stage <<< "$status")" "$(field progress <<< "$status" | awk '{print 100 * $1}')"
  case "$state" in
    done) break ;;
    failed | cancelled) printf '\n'; field error <<< "$status"; get "/api/v1/jobs/$job/log" | tail -20; exit 1 ;;
  esac
  sleep 1
done
printf '\n'

say "the map's figures"
map=$(curl -fsSL -o /dev/null -w '%{url_effective}' "$address/api/v1/sites/demo/maps/latest")
served=$(mktemp -d)
trap 'kill "$service" 2> /dev/null || true; wait "$service" 2> /dev/null || true; rm -rf "$served"' EXIT
for file in map.glb map_plain.glb ground.ply report.json; do curl -fsS "$map/$file" -o "$served/$file"; done
scripts/check_map.py "$served"

echo
echo "viewer: $address/"
if $once; then exit 0; fi
echo "Ctrl-C ends the service."
wait "$service"
