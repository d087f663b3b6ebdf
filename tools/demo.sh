#!/usr/bin/env bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# A real mesh through every stage: installs what is missing, builds, converts, validates, traces.
# Everything it makes is in build/demo.
#
#   tools/demo.sh [--no-install]
set -euo pipefail
cd "$(dirname "$0")/.."
source tools/packages.sh

case ${1:-} in
  '') install_packages "${build_packages[@]}" ;;
  --no-install) ;;
  *) echo "usage: tools/demo.sh [--no-install]" >&2; exit 1 ;;
esac

echo "Building (a few minutes the first time)"
out=build/demo
mkdir -p $out
if ! { cmake --preset release -DTETFMT_BUILD_TESTS=OFF && cmake --build --preset release --target tet; } >$out/build.log 2>&1
then
  tail -n 40 $out/build.log
  echo "The build failed; all of its output is in $out/build.log" >&2
  exit 4
fi
tet=build/release/tools/tet/tet

name=armadillo view=(--azimuth 210)  # the armadillo faces -z
archive=$(mesh_archive "$PWD/build/meshes")
if [ -n "$archive" ]; then
  tar -xzf "$archive" -C $out --strip-components=2 data/meshes/$name.off
else
  echo "Debian's libcgal-demo has no meshes here (package documentation is stripped); making one instead"
  name=torus-knot view=()
  $tet sample $name --triangles 52000 -o $out/$name.off
fi

mesh=$out/$name.off file=$out/$name.tet picture=$out/$name.png
# run COMMAND...: shows the command as one would type it, then runs it and leaves its duration in $seconds.
run() {
  local start
  printf '\n$ tet %s\n' "$*"
  start=$(date +%s%N)
  $tet "$@"
  seconds=$(($(date +%s%N) - start))
  seconds=$(printf '%d.%03d' $((seconds / 1000000000)) $((seconds / 1000000 % 1000)))
}
run convert $mesh -o $file --report $out/report.json -v
run validate $file
validate_seconds=$seconds
run info $file
run trace $file -o $picture "${view[@]}" 2> >(tee $out/trace.txt >&2)

# The reports are our own, one "key": value a line.
field() { sed -n "s/^ *\"$2\": \([^,]*\),\{0,1\}$/\1/p" "$1" | head -n 1; }
thousands() { sed -E ':a; s/^([0-9]+)([0-9]{3})/\1,\2/; ta' <<<"$1"; }
$tet info $file --format json >$out/info.json
hundredths() { printf '%.2f' "$1"; }
cat <<SUMMARY

------------------------------------------------------------------------
  $mesh
    $(thousands "$(field $out/info.json input_triangles)") triangles, $(thousands "$(stat -c %s $mesh)") bytes of text
  $file
    $(thousands "$(field $out/info.json tets)") tets, $(thousands "$(field $out/info.json bytes)") bytes: $(hundredths "$(field $out/info.json bytes_per_tet)") a tet, $(hundredths "$(field $out/info.json bytes_per_input_triangle)") a triangle
  converted  in $(hundredths "$(sed -n 's/^  "seconds": \([^,]*\),\{0,1\}$/\1/p' $out/report.json)") s (the stages are above)
  validated  in $(hundredths $validate_seconds) s: every tet is exact, every triangle is there
  traced     at $(sed -n 's/.* \([0-9.]*\) ns of a thread a ray.*/\1/p' $out/trace.txt) ns a ray on one core

  The picture: $PWD/$picture
------------------------------------------------------------------------
SUMMARY
