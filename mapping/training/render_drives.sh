#!/usr/bin/env bash
# Renders the simulated drives that the network is trained and measured on; what is there already stays.
#   render_drives.sh PARKADE_SIMULATE OUT
set -euo pipefail
[ $# -eq 2 ] || { echo "usage: $0 PARKADE_SIMULATE OUT" >&2; exit 2; }
simulate=$1 out=$2

# drive NAME DURATION SCENE SEED WEATHER DAY [OPTION...]
drive() {
  local folder=$out/$1
  [ -e "$folder/summary.json" ] && return
  rm -rf "$folder"
  mkdir -p "$(dirname "$folder")"
  nice "$simulate" "$3" --seed "$4" --weather "$5" --day "$6" --duration "$2" --rate 1 --size 640x400 --semantic \
    --drop 0 --quiet --set drive.rolling_start=3 --out "$folder" "${@:7}"
}

drive train/lot_1000 20 lot 1000 dry 0 --traffic 2
drive train/garage_1001 20 garage 1001 dry 0 --traffic 2
drive train/street_1002 20 street 1002 dry 0 --traffic 4
drive train/lot_1003 20 lot 1003 wet 1 --traffic 2
drive train/garage_1004 20 garage 1004 dry 1 --traffic 1
drive train/lot_1005 20 lot 1005 overcast 0 --speed-bumps 3
drive train/street_1006 20 street 1006 wet 1 --traffic 4
drive train/lot_1007 20 lot 1007 dusk 0 --traffic 2
drive train/garage_1008 20 garage 1008 dry 2 --traffic 2
drive train/street_1009 20 street 1009 dusk 0 --traffic 3
drive train/lot_1010 20 lot 1010 dry 2 --traffic 1
drive train/garage_1011 20 garage 1011 dry 0 --set image.noise=0
drive train/street_1012 20 street 1012 overcast 0 --traffic 3
drive train/lot_1013 20 lot 1013 wet 0 --traffic 2

drive val/lot_2000 14 lot 2000 overcast 0 --traffic 2
drive val/garage_2001 14 garage 2001 dry 1 --traffic 2
drive val/street_2002 14 street 2002 wet 0 --traffic 4
drive val/lot_2003 14 lot 2003 dusk 1 --traffic 2
