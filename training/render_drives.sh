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
    --set semantic_kind=classes --drop 0 --quiet --set drive.rolling_start=3 --out "$folder" "${@:7}"
}

# 44 places: each weather with each kind of place, none twice alike; half of the looks are mixed.
scenes=(lot garage street lot garage lot street garage)
weathers=(dry wet overcast dusk dry)
looks=(mixed known mixed classic)
for i in {0..22} {24..44}; do
  scene=${scenes[i % 8]} seed=$((1000 + i))
  options=(--traffic $((i % 5)) --set "looks=${looks[i / 2 % 4]}")
  [ "$scene" = lot ] && options+=(--speed-bumps $((i % 3)))
  [ $((i % 6)) = 5 ] && options+=(--set image.noise=0)
  drive "train/${scene}_$seed" 26 "$scene" "$seed" "${weathers[i % 5]}" $((i % 3)) "${options[@]}"
done

# 12 more of other seasons, with drains, dirty lenses and flare.
places=(lot street lot street garage lot) seasons=(winter winter autumn autumn usual winter)
for i in {0..11}; do
  scene=${places[i % 6]} seed=$((1050 + i)) weather=${weathers[i % 5]}
  drive "train/${scene}_$seed" 26 "$scene" "$seed" "$weather" $((i % 3)) --traffic $((i % 3)) --set "looks=${looks[i % 3]}" \
    --set "season=${seasons[i % 6]}" --set "has_drains=$([ $((i % 4)) -lt 2 ] && echo true || echo false)" \
    --set "lens.dirt=0.$((i * 7 % 10))" --set "lens.flare=$([ "$weather" = dry ] && echo 1 || echo 0)"
done

# 72 more, in short: how many places there are matters more than how long each is driven.
places=(lot garage street lot garage street lot garage lot street)
seasons=(usual usual usual autumn usual usual winter usual)
for i in {0..71}; do
  scene=${places[i % 10]} seed=$((1100 + i)) weather=${weathers[i % 5]}
  drive "train/${scene}_$seed" 10 "$scene" "$seed" "$weather" $((i % 3)) --traffic $((i % 4)) --set "looks=${looks[i % 4]}" \
    --set "season=${seasons[i % 8]}" --set "has_drains=$([ $((i % 4)) = 3 ] && echo true || echo false)" \
    --set "lens.dirt=0.$((i % 5 * 2))" \
    --set "lens.flare=$([ "$weather" = dry ] && [ $((i % 2)) = 0 ] && echo 1 || echo 0)"
done

drive val/lot_2000 14 lot 2000 overcast 0 --traffic 2
drive val/garage_2001 14 garage 2001 dry 1 --traffic 2
drive val/street_2002 14 street 2002 wet 0 --traffic 4
drive val/lot_2003 14 lot 2003 dusk 1 --traffic 2
drive val/garage_2004 14 garage 2004 dry 0 --traffic 2
drive val/street_2005 14 street 2005 dry 1 --traffic 4

# Held back: nothing is trained on or chosen by these looks.
drive held/lot_2010 14 lot 2010 dry 0 --traffic 2 --set looks=unknown
drive held/garage_2011 14 garage 2011 dry 0 --traffic 2 --set looks=unknown
drive held/street_2012 14 street 2012 dry 0 --traffic 4 --set looks=unknown
drive held/lot_2013 14 lot 2013 overcast 1 --traffic 2 --set looks=unknown
drive held/street_2014 14 street 2014 wet 1 --traffic 4 --set looks=unknown
drive held/lot_2015 14 lot 2015 dry 0 --traffic 2 --set looks=unknown --set season=winter
drive held/street_2016 14 street 2016 overcast 0 --traffic 2 --set looks=unknown --set season=winter
