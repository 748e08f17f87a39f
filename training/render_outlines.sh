#!/usr/bin/env bash
# Renders the simulated drives that the network of outlines is trained and looked at with, and paints their ground by the
# network of free space, by an earlier one, by it with half of the pictures, and by masks. What is there already stays.
#   render_outlines.sh PARKADE_SIMULATE PARKADE_OUTLINE_RASTERS EARLIER.onnx OUT
set -euo pipefail
[ $# -eq 4 ] || { echo "usage: $0 PARKADE_SIMULATE PARKADE_OUTLINE_RASTERS EARLIER.onnx OUT" >&2; exit 2; }
simulate=$1 paint=$2 earlier=$3 out=$4

# paint_ground DRIVE SET VARIANT [OPTION...]
paint_ground() {
  ls "$out/$2/$1_$3_"*.json >/dev/null 2>&1 && return
  "$paint" --suite "$out/drives" --only "$1" --out "$out/$2/$3" "${@:4}"
  for file in "$out/$2/$3/$1"_*; do
    mv "$file" "$out/$2/$1_$3_${file##*_}"
  done
  rmdir "$out/$2/$3"
}

first_scenes=(lot garage street lot) scenes=(garage street garage lot)  # garages are harder: more of them later
weathers=(dry wet overcast dusk dry overcast dry)
last_scenes=(lot garage lot street)  # lots are worst now
for i in {0..36} {40..59}; do
  if ((i < 18)); then
    scene=${first_scenes[i % 4]} traffic=$((i % 4))
  elif ((i >= 40)); then
    scene=${last_scenes[i % 4]} traffic=$((i % 4))
  else
    scene=${scenes[i % 4]} traffic=$((i / 4 % 4))
  fi
  seed=$((3000 + i))
  name=${scene}_$seed
  folder=$out/drives/$name
  if [ ! -e "$folder/truth/summary.json" ]; then
    rm -rf "$folder"
    mkdir -p "$folder"
    nice "$simulate" "$scene" --seed "$seed" --weather "${weathers[i % 7]}" --day $((i % 3)) --length 60 --rate 3 \
      --size 640x400 --semantic --drop 0 --traffic "$traffic" --quiet --set 'faults.extrinsic_rotation_deg=[0.3]' \
      --set 'faults.extrinsic_translation_cm=[1]' --out "$folder/drive"
    ln -s drive "$folder/truth"
  fi
  case $name in
    lot_3003 | garage_3005 | street_3006 | *_305[6-9]) paint_ground "$name" val network --set ground.use_semantics=false ;;
    *)
      paint_ground "$name" train network --set ground.use_semantics=false
      paint_ground "$name" train earlier --set ground.use_semantics=false --set "ground.freespace_model=$earlier"
      paint_ground "$name" train half --set ground.use_semantics=false --keyframe-distance 2.4
      paint_ground "$name" train masks
      ;;
  esac
done
