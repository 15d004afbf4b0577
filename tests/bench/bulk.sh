#!/usr/bin/env bash
# bulk.sh BIN OUT VIEWS: the latency of recognition, five frames a second, before and during a bulk upload of
# VIEWS views over four streams, and the rate of the upload beside RocksDB's own (graspdb_bulk).
set -euo pipefail
bin=$(realpath "$1")
mkdir -p "$2" && out=$(realpath "$2")
views=$3
source "$(dirname "$0")/../server_process/server.sh"

rm -rf "$out/db" "$out/set" "$out/raw"
"$bin/graspdb" simulate --step 30 --seed 3 --out "$out/set" >/dev/null 2>&1
start_server "$out/server" "$out/db" --log-level warn
"$bin/graspdb" import "$out/set" >/dev/null 2>&1
"$bin/graspdb" bench "$out/set" --duration 40 --rate 5 >"$out/quiet.txt"
"$bin/graspdb_bulk" "$out/raw" --server "$GRASPDB_SERVER" --views "$views" --streams 4 >"$out/bulk.txt" &
upload=$!
# Not while the client makes views and RocksDB writes them alone.
until "$bin/graspdb" uploads list 2>/dev/null | grep -q bulk; do
  kill -0 "$upload"
  sleep 0.2
done
"$bin/graspdb" bench "$out/set" --duration 25 --rate 5 >"$out/during.txt"
wait "$upload"
cat "$out/bulk.txt"
for run in quiet during; do
  echo "$run"
  grep -A2 "min      mean" "$out/$run.txt"
  grep answered "$out/$run.txt"
done
