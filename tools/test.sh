#!/usr/bin/env bash
# Installs, builds with warnings as errors and runs the tests. Labels keep it short: 'slow' and 'shared' (real scans that
# do not come with the repo) run in tools/full_check.sh. Arguments go to ctest.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh
cmake --preset ci
cmake --build --preset ci
ctest --preset ci --no-tests=error --parallel "$(nproc)" --label-exclude 'slow|bench' "$@"
