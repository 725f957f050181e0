#!/usr/bin/env bash
# Builds the program, simulates a small survey, registers it and prints where the report is.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh
cmake --preset release
cmake --build --preset release --target isthmus_program
isthmus=build/release/bin/isthmus
demo=build/demo
"$isthmus" simulate office -o "$demo/scans" --stations 6 --resolution 0.2 --seed 1
"$isthmus" register "$demo/scans" -o "$demo/out"
"$isthmus" evaluate "$demo/out" --truth "$demo/scans/poses.gt.txt"
echo "open $PWD/$demo/out/report.html in a browser"
