#!/usr/bin/env bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Converts every mesh of a folder in both layouts, validates what comes out, and prints what became of each.
#
#   tests/corpus.sh [-r] [-j N] [--slow] DIR [tet convert's options...]
#
#   DIR      or a .tar.gz, which is unpacked first and searched in full
#   -r       folders below DIR too
#   -j N     meshes at a time (1)
#   --slow   files of 1 MB and more too, which are left out otherwise
#
# The program is $TET, else `tet`. One line a mesh as it is done, fields separated by blanks: triangles, seconds, MB
# of memory, tets a triangle, outcome, name; and the message, if there is one. Times and memory are those of the
# tet20 run. Outcomes: "ok" (both layouts validate), "cut" (the same, of a surface whose triangles intersected),
# "no-surface" (an error that says so: exit code 3). Anything else is a FAULT: another failure, more than one line of
# error, a file left behind, more than 300 s. The exit code is 1 if there was any.
set -u
usage() { echo "usage: tests/corpus.sh [-r] [-j N] [--slow] DIR [options of tet convert...]" >&2; exit 1; }
depth=(-maxdepth 1) jobs=1 size=(-size -1024k)
while [ $# -gt 0 ]; do
  case $1 in
    -r) depth=() ;;
    -j) jobs=${2:?}; shift ;;
    --slow) size=() ;;
    -*) usage ;;
    *) break ;;
  esac
  shift
done
[ $# -gt 0 ] && [ -e "$1" ] || usage
dir=$1
shift
export TET=${TET:-tet}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export work
if [ ! -d "$dir" ]; then
  mkdir "$work/archive"
  tar -xzf "$dir" -C "$work/archive" || exit 1
  dir=$work/archive depth=()
fi

# one_mesh OPTION... NUMBER MESH: prints its line, and leaves its outcome in $work/NUMBER.outcome.
one_mesh() {
  local number=${*: -2:1} mesh=${*: -1} outcome=ok detail='' row='' layout code
  local place=$work/$number options=("${@:1:$#-2}")
  mkdir "$place"
  for layout in tet20 tet16; do
    # A batch of one, for its table.
    printf '%s\t%s\n' "$mesh" "$place/out.tet" |
      timeout 300 "$TET" convert --batch - -q --layout $layout "${options[@]}" > "$place/table" 2> "$place/errors"
    code=$?
    local fields
    IFS=$'\t' read -r -a fields < <(sed -n 2p "$place/table")
    [ $layout = tet20 ] && row=$(awk -v n="${fields[1]:-0}" -v s="${fields[3]:-0}" -v m="${fields[4]:-0}" \
      -v t="${fields[5]:-0}" 'BEGIN { printf "%9d %8.2f %7d %8.2f", n, s, m, n ? t / n : 0 }')
    if [ $code -eq 0 ]; then
      [ "${fields[2]}" = "ok (cut)" ] && outcome=cut
      "$TET" validate "$place/out.tet" > /dev/null 2> "$place/errors" || outcome=FAULT
    elif [ $code -eq 3 ] && grep -qE 'no surface|no mesh|no triangle|an area|one and the same' "$place/errors"; then
      outcome=no-surface
    else
      outcome=FAULT
    fi
    [ $code -eq 0 ] && [ $outcome != FAULT ] || detail="$layout, exit code $code: $(head -c 300 "$place/errors")"
    [ "$(wc -l < "$place/errors")" -le 1 ] || outcome=FAULT detail="more than one line: $detail"
    [ $code -eq 0 ] || [ ! -e "$place/out.tet" ] || outcome=FAULT detail="left an output behind: $detail"
    [ -z "$(find "$place" -name '.*' -type f)" ] || outcome=FAULT detail="left a temporary behind: $detail"
    rm -f "$place/out.tet"
    case $outcome in FAULT | no-surface) break ;; esac
  done
  printf '%s  %-10s  %s%s\n' "$row" $outcome "${mesh##*/}" "${detail:+: $detail}"
  echo $outcome > "$work/$number.outcome"
  rm -rf "$place"
}
export -f one_mesh

meshes() {
  find -L "$dir" "${depth[@]}" -type f "$@" \( -iname '*.obj' -o -iname '*.ply' -o -iname '*.stl' -o -iname '*.off' \
    -o -iname '*.drc' -o -iname '*.gltf' -o -iname '*.glb' \)
}
printf '%9s %8s %7s %8s  %-10s  %s\n' triangles seconds MB tets/tri outcome mesh
number=0
meshes "${size[@]}" | LC_ALL=C sort | while IFS= read -r mesh; do
  printf '%s\0%s\0' $((++number)) "$mesh"
done | xargs -0 -r -n 2 -P "$jobs" bash -c 'one_mesh "$@"' one_mesh "$@"

count() { cat "$work"/*.outcome 2> /dev/null | grep -c "^$1\$"; }
total=$(find "$work" -name '*.outcome' | wc -l)
faults=$(count FAULT)
echo "$total meshes: $(count ok) ok, $(count cut) cut, $(count no-surface) without a surface, $faults faults;" \
  "$(($(meshes | wc -l) - $(meshes "${size[@]}" | wc -l))) large ones left out"
[ "$total" -gt 0 ] && [ "$faults" -eq 0 ]
