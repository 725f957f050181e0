#!/usr/bin/env bash
# Installs what building and testing need on a bare Debian 12 (bookworm). Safe to run again.
set -euo pipefail
. "$(dirname "$0")/debian_source.sh"

packages=(
  # tools
  git ca-certificates g++ cmake ninja-build pkg-config ccache mold clang-format
  # libraries: point clouds, linear algebra, threads, optimisation, ray casting, formats, tests
  libpcl-dev libeigen3-dev libtbb-dev libceres-dev libembree-dev libopenmpi-dev
  libyaml-cpp-dev libcli11-dev libfmt-dev libexpected-dev libxxhash-dev nlohmann-json3-dev libpugixml-dev
  libgtest-dev libbenchmark-dev
  # the fuzz targets: clang with libFuzzer and the sanitizers
  clang libclang-rt-14-dev
  # the 3D view of the report, and a browser to test the page in
  chromium
  # a reader of PLY and PTX that shares nothing with ours, without a screen (29 MB)
  cloudcompare
  # plots and the checks of results
  python3 python3-numpy python3-scipy python3-matplotlib python3-open3d
  # a Slurm of two nodes on this machine, for the test of isthmus submit
  slurm-wlm munge
)

# Node.js of another source brings its own npm, and Debian's would conflict with it.
command -v node >/dev/null || packages+=(nodejs)
command -v npm >/dev/null || packages+=(npm)

as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
export DEBIAN_FRONTEND=noninteractive

# LASzip reads and writes LAZ. Debian 12 has no package of it, later releases have; without it everything else works.
install_laszip() {
  local prefix=${ISTHMUS_LASZIP_PREFIX:-/usr/local} work
  for place in /usr "$prefix"; do
    [ -e "$place/include/laszip/laszip_api.h" ] && return
  done
  echo "setup: building LASzip into $prefix"
  work=$(mktemp -d)
  if fetch_debian_source laszip "$work" trixie testing sid && mkdir "$work/source" &&
    tar -xf "$work"/laszip_*.orig.tar.* -C "$work/source" --strip-components=1 &&
    cmake -S "$work/source" -B "$work/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" \
      -DLASZIP_BUILD_STATIC=ON -DCMAKE_POSITION_INDEPENDENT_CODE=ON >"$work/log" 2>&1 &&
    cmake --build "$work/build" --parallel >"$work/log" 2>&1 &&
    "${as_root[@]}" cmake --install "$work/build" >"$work/log" 2>&1; then
    echo "setup: LASzip is installed; configure the build again to have LAZ"
  else
    echo "setup: LASzip could not be had, LAZ files will not be read; the reason:"
    tail -n 3 "$work/log" 2>/dev/null | sed 's/^/setup:   /' || true
  fi
  rm -rf "$work"
}

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "setup: all packages are installed"
else
  echo "setup: installing ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi
install_laszip
echo "setup: done"
