#!/usr/bin/env bash
# Everything: all tests (also slow ones and those on real scans), the format of the sources, the sanitizers.
# ISTHMUS_SHARED names the folder of real scans; without it those tests are skipped and say so.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh
find src pipelines tools tests -name '*.h' -o -name '*.cpp' | xargs clang-format --dry-run --Werror
cmake --preset ci
cmake --build --preset ci
ISTHMUS_KILLS=30 ctest --preset ci --no-tests=error --parallel "$(nproc)"
cmake --preset asan
cmake --build --preset asan
UBSAN_OPTIONS=halt_on_error=1 ctest --test-dir build/asan --no-tests=error --output-on-failure --parallel "$(nproc)" \
  --label-exclude 'slow|shared|bench'
