#!/usr/bin/env bash
# Renders the simulated drives that the network of outlines is trained and looked at with, and paints their ground by
# masks of all level ground, as a mistaken network would, by half of these, and by the network of free space. What is
# there already stays.
#   render_outlines.sh PARKADE_SIMULATE PARKADE_OUTLINE_RASTERS OUT
set -euo pipefail
[ $# -eq 3 ] || { echo "usage: $0 PARKADE_SIMULATE PARKADE_OUTLINE_RASTERS OUT" >&2; exit 2; }
simulate=$1 paint=$2 out=$3

# paint_ground DRIVE SET VARIANT [OPTION...]
paint_ground() {
  ls "$out/$2/$1_$3_"*.json >/dev/null 2>&1 && return
  "$paint" --suite "$out/drives" --only "$1" --out "$out/$2/$3" "${@:4}"
  for file in "$out/$2/$3/$1"_*; do
    mv "$file" "$out/$2/$1_$3_${file##*_}"
  done
  rmdir "$out/$2/$3"
}

# make_place SCENE SEED LOOKS SET
make_place() {
  local name=$1_$2 folder=$out/drives/$1_$2 weathers=(dry wet overcast dusk dry overcast dry)
  if [ ! -e "$folder/truth/summary.json" ]; then
    rm -rf "$folder"
    mkdir -p "$folder"
    nice "$simulate" "$1" --seed "$2" --weather "${weathers[$2 % 7]}" --day $(($2 % 3)) --length 60 --rate 3 \
      --size 640x400 --semantic --set semantic_kind=level --drop 0 --traffic $(($2 % 4)) --quiet --set "looks=$3" \
      --set 'faults.extrinsic_rotation_deg=[0.3]' --set 'faults.extrinsic_translation_cm=[1]' --out "$folder/drive"
    ln -s drive "$folder/truth"
  fi
  paint_ground "$name" "$4" level
  paint_ground "$name" "$4" network --set ground.use_semantics=false
  [ "$4" != train ] || paint_ground "$name" train half --keyframe-distance 2.4
}

scenes=(street lot street lot garage street lot street garage lot)
for i in {0..29}; do make_place "${scenes[i % 10]}" $((4000 + i)) known train; done
for i in {0..4}; do make_place "${scenes[i * 2]}" $((4100 + i)) unknown val; done
