#!/usr/bin/env bash
# idle_streams.sh BIN OUT [SECONDS [CONNECTIONS STREAMS AGAIN]]: a robot's frames beside a flood of connections and streams that
# send nothing (idle_streams.py): of a caller without identity, and of one with an identity. The robot sends five scenes of one
# part a second. Prints a Markdown table of its latency and of the server's processor time, resident memory, descriptors and
# threads before, during and from 5 s after each flood.
set -euo pipefail
bin=$(realpath "$1")
mkdir -p "$2" && out=$(realpath "$2")
seconds=${3:-600} connections=${4:-500} streams=${5:-5000} again=${6:-10}
quiet=$((seconds < 60 ? seconds : 60))
here=$(dirname "$(realpath "$0")")
source "$here/../../server_process/server.sh"
unset GRASPDB_TOKEN_FILE

[ -d "$out/set" ] || "$bin/graspdb" simulate --step 15 --seed 3 --out "$out/set" >/dev/null 2>&1

# identity NAME ROLE...: its token in OUT/NAME.token.
identity() {
  local name=$1 roles=()
  shift
  for role in "$@"; do roles+=(--role "$role"); done
  rm -f "$out/$name.token"
  "$bin/graspdb-server" token "$name" "${roles[@]}" --out "$out/$name.token" >>"$out/identities.jsonl"
}
# The server's processor time, s.
cpu() { awk -v hertz="$(getconf CLK_TCK)" '{ sub(/.*\) /, ""); print ($12 + $13) / hertz }' "/proc/$server/stat"; }
use() {
  awk -v files="$(find "/proc/$server/fd" -mindepth 1 | wc -l)" \
    '/^VmRSS/ { rss = $2 / 1024 } /^Threads/ { threads = $2 } END { printf "%.0f | %d | %d |\n", rss, files, threads }' \
    "/proc/$server/status"
}
# row TEXT SECONDS: the robot's frames for this long, and the server after them.
row() {
  local begun used
  begun=$(date +%s.%N) used=$(cpu)
  "$bin/graspdb" bench --json --simulate --frames 32 --warmup 10 --rate 5 --concurrency 4 --duration "$2" \
    >"$out/frames.json" 2>"$out/frames.log"
  python3 -c '
import json, sys
r = json.load(sys.stdin)
p = {float(q["percent"]): q["ms"] for q in r["latency"]["percentiles"]}
errors = {e["code"]: e["count"] for e in r.get("errors", [])}
print("| %s | %d | %s | %.1f | %.1f | %.0f | " % (sys.argv[1], r["answered"], errors or 0, p[50], p[99], max(p.values())), end="")' \
    "$1" <"$out/frames.json"
  awk -v used="$used" -v now="$(cpu)" -v begun="$begun" -v end="$(date +%s.%N)" \
    'BEGIN { printf "%.2f | ", (now - used) / (end - begun) }'
  use
}
# flood NAME [TOKEN_FILE]
flood() {
  row before "$quiet"
  python3 "$here/idle_streams.py" "$GRASPDB_SERVER" "$connections" "$streams" "$again" "${@:2}" >"$out/$1.json" 2>"$out/$1.err" &
  local pid=$!
  sleep 5  # until all are open
  row "$1" "$seconds"
  kill "$pid"
  wait "$pid"
  sleep 5
  row "5 s after" "$quiet"
}

echo "| | answered | errors | p50, ms | p99, ms | longest, ms | cores | resident, MiB | descriptors | threads |"
echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
for caller in anonymous authenticated; do
  rm -rf "$out/db" "$out/identities.jsonl"
  flags=(--log-level info) token=()
  if [ $caller = authenticated ]; then
    identity robot read recognise teach operate admin
    identity flood read recognise teach
    flags+=(--identities "$out/identities.jsonl") token=("$out/flood.token")
    export GRASPDB_TOKEN_FILE=$out/robot.token
  fi
  start_server "$out/server-$caller" "$out/db" "${flags[@]}"
  "$bin/graspdb" import "$out/set" >/dev/null 2>&1
  flood "$caller" "${token[@]}"
done
