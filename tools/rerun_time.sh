#!/usr/bin/env bash
# rerun_time.sh ISTHMUS [FOLDER]: how long a run with nothing changed takes, as a share of the first one, on 12 simulated
# stations of an office floor (wanted: under 2 %). Printed, not judged: the machine may be busy with other things.
set -euo pipefail

isthmus=$(realpath "$1")
made=
[ $# -ge 2 ] || made=$(mktemp -d)
folder=${2:-$made}
trap '[ -z "$made" ] || rm -r "$made"' EXIT
mkdir -p "$folder"
[ -d "$folder/scans" ] || "$isthmus" simulate office -o "$folder/scans" --stations 12 --resolution 0.2 >/dev/null
sleep 3 # files changed a moment ago are read anew
rm -rf "$folder/out"

# Wall-clock seconds and seconds of all cores, as bash's `time` says them.
measure() {
  local TIMEFORMAT='%R %U %S'
  { time "$isthmus" register "$folder/scans" -o "$folder/out" >"$folder/$1.log" 2>&1; } 2>&1
}
read -r first first_user first_system <<<"$(measure first)"
read -r again again_user again_system <<<"$(measure again)"
awk -v a="$first" -v au="$first_user" -v as="$first_system" -v b="$again" -v bu="$again_user" -v bs="$again_system" 'BEGIN {
  printf "first run: %.2f s (%.2f s of all cores)\n", a, au + as
  printf "run again: %.2f s (%.2f s of all cores)\n", b, bu + bs
  printf "share: %.2f %% of the time, %.2f %% of the work\n", 100 * b / a, 100 * (bu + bs) / (au + as) }'
