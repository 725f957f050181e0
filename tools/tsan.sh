#!/usr/bin/env bash
# tsan.sh [TEST...]: tests under ThreadSanitizer, without arguments all that store, schedule and go from end to end.
# Debian's TBB is not built for it: every hand-over between tasks would be reported, and a suppression for TBB would
# silence all code that runs in tasks. So TBB itself, of the version that the release has, is built for it first, in
# build/tsan-tbb. What stays unseen is in tests/tsan.supp, with reasons. Reports lie in build/tsan/reports.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/debian_source.sh

tests=("$@")
[ $# -gt 0 ] || tests=(store_test pipelines_test determinism_test kill_test end_to_end_test)
tbb=$PWD/build/tsan-tbb
reports=$PWD/build/tsan/reports
export TSAN_OPTIONS="suppressions=$PWD/tests/tsan.supp log_path=$reports/report history_size=4"

# TBB without its allocator, which would hand memory from thread to thread unseen: it falls back to malloc.
build_tbb() {
  [ ! -e "$tbb/installed/lib/cmake/TBB/TBBConfig.cmake" ] || return 0
  rm -rf "$tbb"
  mkdir -p "$tbb/source"
  fetch_debian_source onetbb "$tbb" "$(debian_release)" || { tail -n 3 "$tbb/log"; return 1; }
  tar -xf "$tbb"/onetbb_*.orig.tar.* -C "$tbb/source" --strip-components=1
  cmake -S "$tbb/source" -B "$tbb/build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_INSTALL_PREFIX="$tbb/installed" \
    -DCMAKE_INSTALL_LIBDIR=lib -DTBB_SANITIZE=thread -DTBB_TEST=OFF -DTBBMALLOC_BUILD=OFF -DTBB_STRICT=OFF
  cmake --build "$tbb/build"
  cmake --install "$tbb/build" >/dev/null
}

# Embree brings its own wish for TBB, other libraries may for its allocator: one TBB must serve all, none its allocator.
check_that_one_tbb_serves_all() {
  local program loaded
  for program in isthmus "${tests[@]}"; do
    loaded=$(ldd "build/tsan/bin/$program" | awk '$1 ~ /^libtbb(malloc)?\.so/ {print $3}')
    [ -z "$loaded" ] || [ "$loaded" = "$tbb/installed/lib/libtbb.so.12" ] ||
      { echo "$program loads $loaded, not TBB built for ThreadSanitizer alone"; return 1; }
  done
}

# A race in tasks must be found, a hand-over between them must not pass for one; else what follows says nothing.
check_that_races_are_found() {
  build/tsan/bin/planted_race none || { echo "an orderly hand-over between tasks is reported"; cat "$reports"/report.*; return 1; }
  ! build/tsan/bin/planted_race race || { echo "a race planted in tasks is not reported"; return 1; }
  rm -rf "$reports"
  mkdir -p "$reports"
}

build_tbb
cmake --preset tsan
cmake --build --preset tsan --target planted_race isthmus_program "${tests[@]}"
rm -rf "$reports"
mkdir -p "$reports"
check_that_one_tbb_serves_all
check_that_races_are_found
failed=0
for test in "${tests[@]}"; do
  ISTHMUS_KILLS=${ISTHMUS_KILLS:-2} "build/tsan/bin/$test" || failed=1
done
if compgen -G "$reports/report.*" >/dev/null; then
  cat "$reports"/report.*
  failed=1
fi
[ $failed -ne 0 ] || echo "ThreadSanitizer: nothing found in ${tests[*]}"
exit $failed
