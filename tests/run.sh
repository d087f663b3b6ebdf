#!/usr/bin/env bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Installs what is missing, builds, runs every test. ctest's summary is the last thing printed.
#
#   tests/run.sh [--quick] [--no-install] [-- CMAKE_ARGUMENT...]
#
#   --quick        leave out the run under AddressSanitizer and UndefinedBehaviorSanitizer, and the tests that
#                  take longest (labels: slow)
#   --no-install   install nothing
set -euo pipefail
cd "$(dirname "$0")/.."
source tools/packages.sh

quick=no install=yes
while [ $# -gt 0 ]; do
  case $1 in
    --quick) quick=yes ;;
    --no-install) install=no ;;
    --) shift; break ;;
    *) echo "usage: tests/run.sh [--quick] [--no-install] [-- CMAKE_ARGUMENT...]" >&2; exit 1 ;;
  esac
  shift
done
say() { printf '\n== %s (%d s)\n' "$*" "$SECONDS"; }

if [ $install = yes ]; then
  say "Packages"
  install_packages "${build_packages[@]}" "${test_packages[@]}"
fi
jobs=$(nproc)
meshes=$(mesh_archive "$PWD/build/meshes")

if [ $quick = no ]; then
  say "Library and format tests under AddressSanitizer and UndefinedBehaviorSanitizer"
  cmake --preset asan "$@" >/dev/null
  cmake --build --preset asan -j "$jobs"
  ctest --preset asan -j "$jobs" --progress
fi

say "Release build"
cmake --preset release -DTETFMT_BUILD_TESTS=ON -DTETFMT_MESH_ARCHIVE="$meshes" "$@" >/dev/null
cmake --build --preset release -j "$jobs"

say "All tests"
slow=()
[ $quick = yes ] && slow=(--label-exclude slow)
ctest --preset release -j "$jobs" "${slow[@]}"
