#!/usr/bin/env bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Converts every mesh of a folder in both layouts and prints what became of each.
#
#   tests/corpus.sh DIR [tet convert's options...]
#
# The program is $TET, else `tet`. One line a mesh: triangles, outcome, seconds, memory (tet20 run), tets a
# triangle. Outcomes: "ok" (both layouts validate), "intersects", "refused" (another clear error about the input,
# exit 2, 3 or 5). Anything else is a fault, as are a file left behind after an error, a leftover temporary, and
# a run of more than 300 s; then the exit code is 1.
set -u
tet=${TET:-tet}
dir=${1:?usage: corpus.sh DIR [options of tet convert]}
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
faults=0 ok=0 intersecting=0 refused=0

field() {  # field FILE PATH...: a number out of a report
  python3 -c 'import json,sys
value = json.load(open(sys.argv[1]))
for key in sys.argv[2:]: value = value[key]
print(value)' "$@"
}

printf '%-32s %9s %8s %8s %8s %8s  %s\n' mesh triangles seconds tetgen MB tets/tri outcome
for mesh in "$dir"/*; do
  case ${mesh,,} in *.off | *.obj | *.ply | *.stl | *.drc) ;; *) continue ;; esac
  name=$(basename "$mesh")
  outcome=ok detail=
  for layout in tet20 tet16; do
    rm -f "$work"/out.tet
    timeout 300 "$tet" convert "$mesh" -o "$work/out.tet" --layout $layout --report "$work/$layout.json" -q "$@" \
      2> "$work/errors"
    code=$?
    if [ $code -eq 0 ]; then
      "$tet" validate "$work/out.tet" 2> "$work/errors" || { outcome=FAULT detail="$layout: $(head -c 200 "$work/errors")"; }
    else
      detail=$(head -c 200 "$work/errors")
      if grep -q 'intersects itself' "$work/errors" && [ $code -eq 3 ]; then outcome=intersects
      elif [ $code -eq 2 ] || [ $code -eq 3 ] || [ $code -eq 5 ]; then outcome=refused
      else outcome=FAULT detail="$layout: exit code $code: $detail"; fi
      [ "$(wc -l < "$work/errors")" -eq 1 ] || outcome=FAULT detail="$layout: not one line: $detail"
      [ ! -e "$work/out.tet" ] || outcome=FAULT detail="$layout: left a file behind"
    fi
    [ -z "$(find "$work" -name '.*' -type f)" ] || outcome=FAULT detail="$layout: left a temporary behind"
    [ $outcome = ok ] || break
  done
  case $outcome in
    ok)
      ok=$((ok + 1))
      r=$work/tet20.json
      tets=$(field "$r" result tets) triangles=$(field "$r" surface input_triangles)
      printf '%-32s %9d %8.2f %8.2f %8.0f %8.2f  ok%s\n' "$name" "$triangles" "$(field "$r" seconds)" \
        "$(field "$r" tetgen seconds)" "$(field "$r" peak_memory_mb)" \
        "$(python3 -c "print($tets/$triangles)")" \
        "$(python3 -c 'import json,sys; a=json.load(open(sys.argv[1]))["tetgen"]; print("".join("; -%s: %s" % (f["switches"], f["reason"]) for f in a["failed_attempts"]))' "$r")"
      ;;
    *)
      case $outcome in intersects) intersecting=$((intersecting + 1)) ;; refused) refused=$((refused + 1)) ;; *) faults=$((faults + 1)) ;; esac
      printf '%-32s %9s %8s %8s %8s %8s  %s: %s\n' "$name" - - - - - "$outcome" "$detail"
      ;;
  esac
done
echo "$ok ok, $intersecting intersect, $refused refused, $faults faults"
[ $faults -eq 0 ]
