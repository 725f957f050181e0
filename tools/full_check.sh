#!/usr/bin/env bash
# full_check.sh [STEP...]: everything, some hours, or only the named steps. What fails is named at the end; the steps after
# it run all the same. ISTHMUS_SHARED names the folder of real scans; without it those tests are skipped and say so.
# What is measured is printed; docs/checked_with.md has what came of it.
set -uo pipefail
cd "$(dirname "$0")/.."

# setup: what building and testing need.
setup() { tools/setup.sh; }

# format: of the sources.
format() { find src pipelines tools tests -name '*.h' -o -name '*.cpp' | xargs clang-format --dry-run --Werror; }

# build: what the steps after it run.
build() { cmake --preset ci && cmake --build --preset ci && cmake --preset fuzz && cmake --build --preset fuzz; }

# tests: all of them, also slow ones and those on real scans, with 30 kills and a scan of 100 million points.
tests() { ISTHMUS_KILLS=30 ISTHMUS_MEMORY_POINTS=100000000 ctest --preset ci --no-tests=error --parallel "$(nproc)"; }

# rerun: the time of a run with nothing changed.
rerun() { tools/rerun_time.sh build/ci/bin/isthmus; }

# fuzzing: an hour over all targets, with the seeds of the ci build.
fuzzing() {
  local each=$((3600 / $(find build/fuzz/fuzz -name 'fuzz_*' -type f | wc -l)))
  tests/fuzz/run.sh build/ci/bin/make_fuzz_seeds build/fuzz/fuzz "$each" build/fuzz/hour
}

# asan: what reads, stores and schedules, under AddressSanitizer and UndefinedBehaviorSanitizer; a report ends the test.
asan() {
  local targets=(test_io store_test pipelines_test determinism_test kill_test end_to_end_test) target failed=0
  cmake --preset asan && cmake --build --preset asan --target "${targets[@]}" || return 1
  for target in "${targets[@]}"; do
    ISTHMUS_KILLS=2 UBSAN_OPTIONS="halt_on_error=1:print_stacktrace=1:suppressions=$PWD/tests/ubsan.supp" "build/asan/bin/$target" || failed=1
  done
  return $failed
}

# tsan: what stores, schedules and goes from end to end, under ThreadSanitizer with a TBB built for it.
tsan() { tools/tsan.sh; }

steps=("$@")
[ $# -gt 0 ] || steps=(setup format build tests rerun fuzzing asan tsan)
failed=()
for step in "${steps[@]}"; do
  declare -F "$step" >/dev/null || { echo "there is no step '$step'"; exit 2; }
  echo "== $step"
  SECONDS=0
  "$step" || failed+=("$step")
  echo "== $step took $((SECONDS / 60)) min"
done
[ ${#failed[@]} -eq 0 ] || { echo "FAILED: ${failed[*]}"; exit 1; }
echo "everything passed: ${steps[*]}"
