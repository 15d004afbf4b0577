#!/usr/bin/env bash
# serving.sh BIN OUT: throughput and latency of a server over gRPC with 10,000 views, the gain of a
# second core, the cost of a bulk import for other callers, and the start with 100,000 views. Client
# and server share the machine. Prints a Markdown table and writes it to OUT/serving.md.
set -euo pipefail
bin=$(realpath "$1")
mkdir -p "$2" && out=$(realpath "$2")
requests=${REQUESTS:-400}
load=(bench --simulate --frames 32 --verified-views 10)
source "$(dirname "$0")/../server_process/server.sh"

# run_load FLAG...: answers a second; the report of the load test is in OUT/load.txt.
run_load() {
  ${CLIENT[@]+"${CLIENT[@]}"} "$bin/graspdb" "${load[@]}" "$@" 2>/dev/null >"$out/load.txt"
  awk '/ answered \(/ { match($0, /\([0-9.]+/); print substr($0, RSTART + 1, RLENGTH - 1) }' "$out/load.txt"
}

# measure NAME FLAG...: a row of the table.
measure() {
  local rate
  rate=$(run_load --requests "$requests" "${@:2}")
  awk -v name="$1" -v rate="$rate" '$1 == "min" && $2 == "mean" {
    getline
    printf "| %s | %.1f | %.1f | %.1f | %.1f | %.0f |\n", name, $3, $4, $5, $7, rate
  }' "$out/load.txt" | tee -a "$out/serving.md"
}

median() { sort -g | sed -n 3p; }

# scale CALLERS: a row of the table; rounds on one core and on two take turns, five each.
scale() {
  local round one two
  : >"$out/one.txt" >"$out/two.txt" >"$out/ratio.txt"
  for round in 1 2 3 4 5; do
    taskset -acp 0 "$server" >/dev/null
    one=$(CLIENT=(taskset -c 0) && run_load --requests $((3 * requests)) --concurrency "$1")
    taskset -acp 0,1 "$server" >/dev/null
    two=$(run_load --requests $((3 * requests)) --concurrency "$1")
    echo "$one" >>"$out/one.txt"
    echo "$two" >>"$out/two.txt"
    awk "BEGIN { printf \"%.2f\\n\", $two / $one }" >>"$out/ratio.txt"
  done
  printf '| %d | %.0f | %.0f | %s | %s to %s |\n' "$1" "$(median <"$out/one.txt")" \
    "$(median <"$out/two.txt")" "$(median <"$out/ratio.txt")" \
    "$(sort -g "$out/ratio.txt" | head -n 1)" "$(sort -g "$out/ratio.txt" | tail -n 1)" |
    tee -a "$out/serving.md"
}

[ -d "$out/10000.db" ] || "$bin/graspdb_fill" "$out/10000.db" 10000
[ -d "$out/100000.db" ] || "$bin/graspdb_fill" "$out/100000.db" 100000
rm -rf "$out/teach" "$out/changed.db"
"$bin/graspdb" simulate --step 15 --seed 3 --out "$out/teach" 2>/dev/null

{
  echo "| 10,000 views | p50, ms | p90 | p99 | longest | answers/s |"
  echo "| --- | --- | --- | --- | --- | --- |"
} | tee "$out/serving.md"
cp -r "$out/10000.db" "$out/changed.db"
start_server "$out/server" "$out/changed.db" --log-level warn
measure "one caller"
measure "one caller, one part" --parts l-bracket
measure "two callers" --concurrency 2
measure "four callers" --concurrency 4
# The import usually runs on another machine; here it lowers its priority.
nice "$bin/graspdb" import "$out/teach" >/dev/null 2>&1 &
import=$!
measure "one caller, while $(find "$out/teach" -name '*.pcd' | wc -l) views are taught"
wait "$import"
rm -rf "$out/changed.db"

{
  echo
  echo "| callers | answers/s on one core | on two cores | times | range |"
  echo "| --- | --- | --- | --- | --- |"
} | tee -a "$out/serving.md"
start_server "$out/server" "$out/10000.db" --log-level warn
scale 2
scale 4

{
  echo
  echo "| start with 100,000 views | ms until it answers | resident, MiB |"
  echo "| --- | --- | --- |"
} | tee -a "$out/serving.md"

# started NAME: a row of the table.
started() {
  local begin ms
  stop_server
  begin=$(date +%s%N)
  start_server "$out/server" "$out/100000.db" --log-level warn
  ms=$((($(date +%s%N) - begin) / 1000000))
  echo "| $1 | $ms | $(resident) |" | tee -a "$out/serving.md"
}
resident() { echo "$(($(awk '/VmRSS/ { print $2 }' "/proc/$server/status") / 1024))"; }

stop_server
for file in "$out"/100000.db/*; do
  [ ! -f "$file" ] || dd if="$file" iflag=nocache count=0 status=none
done
started "nothing of the database in the page cache"
for round in 1 2 3 4 5; do started "$round"; done
{
  echo
  echo "| 100,000 views of 4,173 objects | p50, ms | p90 | p99 | longest | answers/s |"
  echo "| --- | --- | --- | --- | --- | --- |"
} | tee -a "$out/serving.md"
measure "one caller"
{
  echo
  echo "Resident after them: $(resident) MiB."
} | tee -a "$out/serving.md"
