#!/usr/bin/env bash
# run.sh SEED_MAKER FUZZERS SECONDS FOLDER [TARGET...]: each fuzz target for so many seconds, from fresh seeds. What it
# finds lies in FOLDER/TARGET/findings. Leaves with 77 where there are no fuzzers (they need clang and libFuzzer).
set -euo pipefail

seed_maker=$1 fuzzers=$2 seconds=$3 folder=$4
shift 4
if ! compgen -G "$fuzzers/fuzz_*" >/dev/null; then
  echo "skipped: no fuzz targets in $fuzzers (cmake --preset fuzz && cmake --build --preset fuzz; needs clang and libFuzzer)"
  exit 77
fi
"$seed_maker" "$folder"
found=0
targets=("$@")
[ ${#targets[@]} -gt 0 ] || for fuzzer in "$fuzzers"/fuzz_*; do targets+=("${fuzzer##*/fuzz_}"); done
for name in "${targets[@]}"; do
  here=$folder/$name
  mkdir -p "$here/corpus" "$here/findings"
  # A hang is 20 s for one input of at most 64 KiB (a millisecond is usual); no input may make it ask for 256 MB at once.
  # The quarantine is kept small: with the usual 256 MB most of the time goes into fresh pages.
  if ASAN_OPTIONS=quarantine_size_mb=8 UBSAN_OPTIONS=print_stacktrace=1 "$fuzzers/fuzz_$name" -seed=1 -max_total_time="$seconds" -max_len=65536 -timeout=20 \
      -malloc_limit_mb=256 -rss_limit_mb=2048 -verbosity=0 -print_final_stats=1 -artifact_prefix="$here/findings/" \
      "$here/corpus" "$here/seeds" >"$here/log.txt" 2>&1; then
    result="nothing found"
  else
    result="FOUND: see $here/log.txt"
    found=1
  fi
  executed=$(sed -n 's/^stat::number_of_executed_units: *//p' "$here/log.txt")
  echo "$name: ${executed:-?} executions, $result"
done
exit $found
