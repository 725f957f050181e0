#!/usr/bin/env bash
# Installs what building and testing need on a bare Debian 12 (bookworm). Safe to run again.
set -euo pipefail

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
  # plots and the checks of results
  python3 python3-numpy python3-scipy python3-matplotlib python3-open3d
  # a Slurm of two nodes on this machine, for the test of isthmus submit
  slurm-wlm munge
)

# Node.js of another source brings its own npm, and Debian's would conflict with it.
command -v node >/dev/null || packages+=(nodejs)
command -v npm >/dev/null || packages+=(npm)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "setup: everything is installed"
  exit 0
fi

echo "setup: installing ${missing[*]}"
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
echo "setup: done"
