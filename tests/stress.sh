#!/usr/bin/env bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Converts real meshes, the same scaled and moved away, and meshes made to hurt; then runs `tet bench --stress` on all
# of them at once.
#
#   tests/stress.sh [--quick] [--keep DIR] [options of tet bench --stress...] [MESHES]
#
#   --quick      fewer meshes, small ones
#   --keep DIR   leave the converted files in DIR, and take those that are there already
#   MESHES       CGAL's example meshes (Debian: libcgal-demo): a .tar.gz, or a folder that holds data/meshes. Without
#                them, or if the name is that of no file, meshes of `tet sample` stand in.
#
# The program is $TET, else `tet`. Exit code: that of `tet bench`, 7 if any answer is wrong.
set -euo pipefail
quick=no keep='' options=() archive=''
while [ $# -gt 0 ]; do
  case $1 in
    --quick) quick=yes ;;
    --keep) keep=${2:?--keep needs a folder}; shift ;;
    --rays | --seed | --threads | --sets | --csv | --json) options+=("$1" "${2:?$1 needs a value}"); shift ;;
    -*) sed -n '3,14s/^# \{0,1\}//p' "$0" >&2; exit 1 ;;
    *) archive=$1 ;;
  esac
  shift
done
tet=${TET:-tet}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
made=${keep:-$work/tet}
mkdir -p "$made"

meshes=''
if [ -d "$archive/data/meshes" ]; then
  meshes=$archive/data/meshes
elif [ -f "$archive" ]; then
  tar -xzf "$archive" -C "$work" data/meshes
  meshes=$work/data/meshes
fi

files=()
# convert NAME MESH [OPTION...]: MESH becomes NAME.tet, which is tested.
convert() {
  local name=$1 mesh=$2
  shift 2
  [ -f "$made/$name.tet" ] || "$tet" convert "$mesh" -q -o "$made/$name.tet" "$@"
  files+=("$made/$name.tet")
}
# moved SCALE SHIFT MESH NAME: an OFF file with every coordinate times SCALE plus SHIFT sizes of the mesh, in x.
moved() {
  awk -v scale="$1" -v shift="$2" '
    FNR == 1 { pass++; count = 0; seen = 0 }
    /^[ \t]*(#|$)/ || $1 == "OFF" { if (pass == 2) print; next }
    !seen { seen = 1; points = $1; if (pass == 2) print; next }
    count++ < points {
      if (pass == 1) { if (count == 1 || $1 < low) low = $1; if (count == 1 || $1 > high) high = $1; next }
      printf "%.17g %.17g %.17g\n", ($1 + shift * (high - low)) * scale, $2 * scale, $3 * scale; next
    }
    pass == 2' "$3" "$3" > "$work/$4.off"
  convert "$4" "$work/$4.off"
}

if [ -n "$meshes" ]; then
  real=(rotor_small three_peaks fandisk)
  [ $quick = yes ] || real+=(armadillo refined_elephant dino lion-head knot2 cow anchor_dense femur bones elephant mushroom)
  for name in "${real[@]}"; do convert "$name" "$meshes/$name.off"; done
  base=$meshes/three_peaks.off
  [ $quick = yes ] || base=$meshes/fandisk.off
else
  echo "stress.sh: no real meshes here (Debian: libcgal-demo); meshes of \`tet sample\` stand in" >&2
  for kind in torus-knot bumpy-plane knots; do
    "$tet" sample $kind -o "$work/$kind.off" --triangles 8000 2> "$work/log"
    convert $kind "$work/$kind.off"
  done
  base=$work/bumpy-plane.off
fi
moved 1e-6 0 "$base" tiny
moved 1e6 0 "$base" huge
moved 1 1e5 "$base" away
for kind in needles slivers lattice; do
  "$tet" sample $kind -o "$work/$kind.off" --triangles 1500 2> "$work/log" || { cat "$work/log" >&2; exit 4; }
  convert $kind "$work/$kind.off"
done
"$tet" bench --stress "${files[@]}" "${options[@]}"
