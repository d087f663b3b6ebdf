#!/usr/bin/env bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# The example scenes: takes meshes from Debian's libcgal-demo (or makes some), places them in rooms, converts,
# traces. Needs nothing but a built `tet`, and minutes (less with --samples 4). Everything it makes is in FOLDER.
#
#   tools/trace/scenes/make.sh [TET [FOLDER [TRACE_OPTION...]]]     (build/release/tools/tet/tet, build/scenes)
set -euo pipefail
cd "$(dirname "$0")/../../.."
source tools/packages.sh
tet=${1:-build/release/tools/tet/tet} out=${2:-build/scenes} here=tools/trace/scenes
options=("${@:3}")
mkdir -p "$out"

# mesh NAME KIND: the path of CGAL's mesh NAME, or of a `tet sample KIND` in its place.
archive=$(mesh_archive "$PWD/build/meshes")
mesh() {
  if [ -n "$archive" ]; then
    [ -f "$out/$1.off" ] || tar -xzf "$archive" -C "$out" --strip-components=2 "data/meshes/$1.off"
  else
    [ -f "$out/$1.off" ] || "$tet" sample "$2" -o "$out/$1.off" --triangles 20000 2>/dev/null
  fi
  echo "$out/$1.off"
}
# place NAME MESH VARIABLE=VALUE...: $out/NAME.obj, as place.awk has it
place() {
  local name=$1 mesh=$2 settings=()
  shift 2
  for setting; do settings+=(-v "$setting"); done
  awk -v "name=$name" "${settings[@]}" -f $here/place.awk "$mesh" >"$out/$name.obj"
}
# quad MATERIAL X0 Y0 Z0 X1 Y1 Z1 X2 Y2 Z2 X3 Y3 Z3: a rectangle of OBJ
quad() {
  local material=$1
  shift
  printf 'v %s %s %s\n' "$@"
  printf 'usemtl %s\nf -4 -3 -2 -1\n' "$material"
}
# checkers HALF STEP: a floor of two kinds of tiles, as one surface
checkers() {
  awk -v half="$1" -v step="$2" 'BEGIN {
    n = 2 * half / step
    for (j = 0; j <= n; j++) for (i = 0; i <= n; i++) print "v", i * step - half, 0, j * step - half
    for (kind = 0; kind < 2; kind++) {
      print "usemtl", kind ? "dark" : "light"
      for (j = 0; j < n; j++) for (i = 0; i < n; i++) if ((i + j) % 2 == kind) {
        a = i + 1 + j * (n + 1)
        print "f", a, a + n + 1, a + n + 2, a + 1
      }
    }
  }'
}
# make SCENE INPUT...: converts and traces
make() {
  local scene=$1
  shift
  "$tet" convert "$@" -o "$out/$scene.tet" -q
  cp $here/"$scene.json" "$out/"
  "$tet" trace "$out/$scene.json" -o "$out/$scene.png" "${options[@]}"
}
printf 'newmtl light\nKd 0.75 0.72 0.68\nnewmtl dark\nKd 0.12 0.14 0.17\nnewmtl plain\nKd 0.7 0.7 0.7\nnewmtl lamp\nKd 0 0 0\n' >"$out/room.mtl"

# A glass bunny on tiles, under a square lamp.
place bunny "$(mesh bunny00 torus-knot)" height=1 lift=0.002 turn=-25
{
  echo 'mtllib room.mtl'
  checkers 8 0.5
  quad lamp -1.9 2.4 -0.3 -1.1 2.4 -0.3 -1.1 2.4 0.5 -1.9 2.4 0.5
} >"$out/tiles.obj"
make glass "$out/tiles.obj" "$out/bunny.obj"

# Smooth, coloured shapes between two mirrors.
"$tet" sample sphere -o "$out/ball.obj" --triangles 5000 2>/dev/null
"$tet" sample torus-knot -o "$out/knot.off" --triangles 16000 2>/dev/null
place sphere "$out/ball.obj" height=0.9 x=1.05 z=0.2 lift=0.002
place rainbow "$out/knot.off" height=1.1 x=-0.55 z=-0.1 lift=0.002 rainbow=1 turn=20
place elephant "$(mesh elephant torus-knot)" height=0.85 x=0.15 z=0.8 lift=0.002 turn=60
{
  echo 'mtllib room.mtl'
  quad plain -40 0 -40 -40 0 40 40 0 40 40 0 -40
  quad dark -1.9 0.05 -1.2 1.9 0.05 -1.2 1.9 1.75 -1.2 -1.9 1.75 -1.2
} >"$out/mirror-room.obj"
make mirror "$out/mirror-room.obj" "$out/sphere.obj" "$out/rainbow.obj" "$out/elephant.obj"

# Nothing but the sky, and what keeps it away.
place dragon "$(mesh ChineseDragon-10kv torus-knot)" height=1 lift=0.002 turn=25
{
  echo 'mtllib room.mtl'
  quad plain -40 0 -40 -40 0 40 40 0 40 40 0 -40
} >"$out/floor.obj"
make occlusion "$out/floor.obj" "$out/dragon.obj"
echo "The pictures: $out/{glass,mirror,occlusion}.png"
