#!/usr/bin/env bash
# Everything, some hours: all tests (also slow ones and those on real scans), 30 kills, a scan of 100 million points, the
# time of a rerun, an hour of fuzzing, the sanitizers, the format of the sources. ISTHMUS_SHARED names the folder of real
# scans; without it those tests are skipped and say so. What was measured is printed; docs/checked_with.md has it.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh
find src pipelines tools tests -name '*.h' -o -name '*.cpp' | xargs clang-format --dry-run --Werror
cmake --preset ci
cmake --build --preset ci
cmake --preset fuzz
cmake --build --preset fuzz
ISTHMUS_KILLS=30 ISTHMUS_MEMORY_POINTS=100000000 ctest --preset ci --no-tests=error --parallel "$(nproc)"

tools/rerun_time.sh build/ci/bin/isthmus

# An hour over all targets, with the seeds of the ci build.
tests/fuzz/run.sh build/ci/bin/make_fuzz_seeds build/fuzz/fuzz $((3600 / $(find build/fuzz/fuzz -name 'fuzz_*' | wc -l))) build/fuzz/hour

# The tests that read, store and schedule, under AddressSanitizer and UndefinedBehaviorSanitizer; a report ends the test.
sanitized=(test_io store_test pipelines_test determinism_test kill_test end_to_end_test)
cmake --preset asan
cmake --build --preset asan --target "${sanitized[@]}"
for test in "${sanitized[@]}"; do
  ISTHMUS_KILLS=2 UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 "build/asan/bin/$test"
done

# Under ThreadSanitizer only what makes threads of its own: Debian's TBB is not built for it, so that every hand-over between
# tasks would be reported, and a suppression for TBB would silence all code that runs in tasks.
cmake --preset tsan
cmake --build --preset tsan --target store_test
TSAN_OPTIONS=halt_on_error=1 build/tsan/bin/store_test
