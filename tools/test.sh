#!/usr/bin/env bash
# Installs, builds with warnings as errors and runs the tests but those labelled 'slow' and 'bench', which are left to
# tools/full_check.sh. Tests labelled 'shared' need real scans that do not come with the repo and are skipped without them.
# Arguments go to ctest.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh
cmake --preset ci
cmake --build --preset ci
ISTHMUS_KILLS=5 ctest --preset ci --no-tests=error --parallel "$(nproc)" --label-exclude 'slow|bench' "$@"
