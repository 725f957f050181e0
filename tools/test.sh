#!/usr/bin/env bash
# Installs, builds with warnings as errors and runs the tests but those labelled 'slow' and 'bench', which are left to
# tools/full_check.sh. Tests labelled 'shared' need real scans that do not come with the repo and are skipped without them.
# Arguments go to ctest.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh
cmake --preset ci
cmake --build --preset ci
# The fuzz targets need clang with libFuzzer; without them their test is skipped and says so.
if command -v clang++ >/dev/null; then
  cmake --preset fuzz && cmake --build --preset fuzz || echo "the fuzz targets could not be built"
fi
ISTHMUS_KILLS=5 ISTHMUS_MEMORY_POINTS=10000000 ctest --preset ci --no-tests=error --parallel "$(nproc)" --label-exclude 'slow|bench' "$@"
