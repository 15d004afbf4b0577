#!/usr/bin/env bash
# counts.sh BIN: instructions of each step, counted by callgrind, ours and the peer's, as a Markdown
# table. Unlike times they are the same on every run and on a busy machine, so that small changes
# show. Steps with thousands of views are left out: rendering them would take a quarter of an hour
# under callgrind.
set -euo pipefail
bin=$(realpath "$1")
works=("frame to descriptor, kinect-v2-one" "frame to descriptor, kinect-v2-five"
  "one registration, l-bracket, kinect-v2" "one registration, post-plate, kinect-v2"
  "one registration, wedge, kinect-v2")
log=$(mktemp)
trap 'rm -f "$log"' EXIT

# count WORK PROGRAM: millions of instructions of one round.
count() {
  valgrind --tool=callgrind --collect-atstart=no --callgrind-out-file=/dev/null "$bin/graspdb_bench" \
    --benchmark_filter="^$1 [|] $2\$" --benchmark_repetitions=1 --benchmark_min_time=0 \
    >/dev/null 2>"$log" || { cat "$log" >&2; exit 1; }
  awk '/ Collected : / { found = $4 } END { if (!found) exit 1; printf "%.2f", found / 1e6 }' "$log"
}

echo "| work | program | million instructions | times ours |"
echo "| --- | --- | --- | --- |"
for work in "${works[@]}"; do
  peers=(PCL)
  [[ $work != *registration* ]] || peers=("PCL ICP with normals" "PCL ICP")
  ours=$(count "$work" graspdb)
  echo "| $work | graspdb | $ours | 1 |"
  for peer in "${peers[@]}"; do
    theirs=$(count "$work" "$peer")
    echo "| $work | $peer | $theirs | **$(awk "BEGIN { printf \"%.1f\", $theirs / $ours }")** |"
  done
done
