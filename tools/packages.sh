# SPDX-License-Identifier: AGPL-3.0-or-later
# What the scripts need from Debian 12, and how they get it. Sourced by tools/demo.sh, tests/run.sh, .ci/run.

build_packages=(g++ cmake ninja-build ccache
  libboost-dev libxxhash-dev libhwy-dev                                   # the library
  libcgal-dev libtet1.5-dev libdraco-dev libopenmesh-dev libtinygltf-dev    # the converter
  libcli11-dev nlohmann-json3-dev libpng-dev libopenexr-dev libtbb-dev    # the tet command
  libcgal-demo)                                                           # real meshes
test_packages=(libgtest-dev
  libembree-dev)                                                          # a peer of `tet bench`, which does without it
check_packages=(clang-14 libclang-rt-14-dev clang-format-14 clang-tidy-14)

# install_packages NAME...: installs those that are missing; with none missing it needs neither root nor network.
install_packages() {
  local name missing=() as_root=()
  for name in "$@"; do
    dpkg-query -W -f '${Status}' "$name" 2>/dev/null | grep -q ' installed$' || missing+=("$name")
  done
  [ ${#missing[@]} -eq 0 ] && return
  if ! command -v apt-get >/dev/null; then
    echo "This script installs Debian packages, and there is no apt-get here. Needed: ${missing[*]}" >&2
    return 1
  fi
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "Packages are missing, and there is neither root nor sudo to install them. As root:" >&2
      echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  echo "Installing ${missing[*]}"
  "${as_root[@]}" apt-get update -q >/dev/null
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -q --no-install-recommends "${missing[@]}" </dev/null >/dev/null
}

# mesh_archive FOLDER: prints the path of CGAL's example meshes, or nothing if they cannot be had. Where the
# system strips package documentation (small containers do), the package is unpacked into FOLDER instead.
mesh_archive() {
  local installed=/usr/share/doc/libcgal-dev/data.tar.gz folder=$1
  if [ -f "$installed" ]; then
    echo "$installed"
    return
  fi
  if [ ! -f "$folder$installed" ]; then
    mkdir -p "$folder"
    (cd "$folder" && apt-get download -q libcgal-demo && dpkg-deb --fsys-tarfile libcgal-demo_*.deb |
      tar -x ".$installed") >/dev/null 2>&1 || true
  fi
  if [ -f "$folder$installed" ]; then echo "$folder$installed"; fi
}
