#!/usr/bin/env bash
# The same survey by one process and by a Slurm of two nodes, one of them killed in the middle: the same bytes.
# Arguments: the program, a folder for the test. Exit code 77: Slurm is not installed, or we are not root.
set -euo pipefail
isthmus=$1
work=$2
cd "$(dirname "$0")"
. ./cluster.sh

have_slurm || { echo "SKIPPED: needs slurm-wlm and munge, and root to start them"; exit 77; }
rm -rf "$work"
mkdir -p "$work"
trap stop_cluster EXIT
start_cluster "$work/cluster"
settings=(--set sampling.target_points=4000 --set pair.max_hypotheses=40)

fail() {
  echo "FAILED: $*"
  tail -n 3 "$work"/*/submit/*.log 2>/dev/null || true
  squeue || true
  exit 1
}
same_bytes() {
  for file in scans.csv links.csv poses.txt pose_graph.g2o; do
    cmp "$work/whole/$file" "$1/$file" || fail "$file of $1 differs"
  done
}
# Until the survey is finished or ten minutes are over.
wait_for() {
  for _ in $(seq 600); do
    "$isthmus" status "$1" >"$work/status" && return 0
    sleep 1
  done
  cat "$work/status"
  fail "not finished after ten minutes"
}

"$isthmus" simulate office -o "$work/scans" --stations 5 --resolution 0.5 --seed 1
"$isthmus" register "$work/scans" -o "$work/whole" --threads 1 "${settings[@]}" || [ $? -eq 3 ]  # 3: not all hang together
submit=("$isthmus" submit "$work/scans" --engine slurm --partition main --task-minutes 0.05 "${settings[@]}")

echo "== two nodes"
"${submit[@]}" -o "$work/two" >"$work/submitted"
cat "$work/submitted"
grep -q "pairs, 8 tasks" "$work/submitted" || fail "the array is not as large as the limit of the cluster lets it"
"${submit[@]}" -o "$work/two" && fail "submitted twice"
"$isthmus" status "$work/two" && fail "finished at once"
wait_for "$work/two"
cat "$work/status"
same_bytes "$work/two"
nodes=$(cat "$work"/two/submit/*.log | wc -l)
[ "$nodes" -gt 0 ] || fail "no task said anything"
"${submit[@]}" -o "$work/two" >"$work/submitted"
[ "$(grep -c '^job ' "$work/submitted")" = 1 ] || fail "a finished survey was submitted with more than its solution"
for _ in $(seq 120); do
  [ -z "$(squeue --noheader)" ] && break
  sleep 1
done
same_bytes "$work/two"

echo "== one node killed"
"${submit[@]}" -o "$work/killed"
for _ in $(seq 600); do
  [ -n "$(squeue --noheader --nodelist=n2 --states=RUNNING --format=%i | head -1)" ] &&
    [ -n "$(find "$work/killed/store/pair" -name '*.artifact' 2>/dev/null | head -1)" ] && break
  sleep 0.2
done
kill_node n2 "$pid_of_n2" || fail "no task ran on n2"
wait_for "$work/killed"
cat "$work/status"
same_bytes "$work/killed"
echo "PASSED"
