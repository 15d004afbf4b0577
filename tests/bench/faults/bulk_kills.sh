#!/usr/bin/env bash
# bulk_kills.sh BIN OUT VIEWS: one bulk upload of VIEWS views during which first the client and then the server
# is killed by SIGKILL, while another program recognises five frames a second. Prints what the catalogue had
# before, at both kills and after the commit, and the latency of recognition; fails where it changes before the
# commit, lacks a view after it, or staged views are lost.
set -euo pipefail
bin=$(realpath "$1")
mkdir -p "$2" && out=$(realpath "$2")
views=$3
source "$(dirname "$0")/../../server_process/server.sh"
cell='' upload=''
trap 'kill -9 $cell $upload 2>/dev/null || true; stop_server' EXIT

# The number KEY of the JSON object on stdin.
number() { sed -n "s/.*\"$1\":\"\([0-9]*\)\".*/\1/p"; }
staged() { "$bin/graspdb" uploads list --json 2>/dev/null | number stagedViewCount; }
catalogue_views() { "$bin/graspdb" status --json | number viewCount; }
# expect VALUE CONDITION...: of test(1).
expect() {
  [ "$@" ] || { echo "bulk_kills.sh: expected $*" >&2; exit 1; }
}
wait_for_staged() {
  until [ "$(staged || true)" -ge "$1" ] 2>/dev/null; do
    kill -0 "$upload"
    sleep 0.2
  done
}
upload() {
  "$bin/graspdb_bulk" "$out/raw" --server "$GRASPDB_SERVER" --views "$views" --upload-only &
  upload=$!
}
# A program in the background ignores SIGINT unless it is set back.
recognize=(env --default-signal=INT "$bin/graspdb" bench "$out/set" --rate 5)

rm -rf "$out/db" "$out/set"
"$bin/graspdb" simulate --step 30 --seed 3 --out "$out/set" >/dev/null 2>&1
start_server "$out/server" "$out/db" --log-level warn
"$bin/graspdb" import "$out/set" >/dev/null 2>&1
before=$(catalogue_views)
echo "views before: $before"
"${recognize[@]}" --duration 30 >"$out/quiet.txt" 2>&1

upload
"${recognize[@]}" --duration 3600 >"$out/during.txt" 2>&1 &
cell=$!
wait_for_staged $((views / 3))
kill -9 "$upload"
{ wait "$upload" || true; } 2>/dev/null
first=$(staged)
echo "client killed: staged $first, in the catalogue $(catalogue_views)"
expect "$(catalogue_views)" -eq "$before"

upload
wait_for_staged $((2 * views / 3))
kill -9 "$server"
{ wait "$server" || true; } 2>/dev/null
server=''
listen=$GRASPDB_SERVER start_server "$out/server" "$out/db" --log-level warn
second=$(staged)
echo "server killed and started again: staged $second, in the catalogue $(catalogue_views)"
expect "$second" -ge $((2 * views / 3))
expect "$(catalogue_views)" -eq "$before"
wait "$upload" || { upload; wait "$upload"; }  # continues, as an integrator would
upload=''
echo "committed: in the catalogue $(catalogue_views)"
expect "$(catalogue_views)" -eq $((before + views))
kill -INT "$cell"
wait "$cell" || true
cell=''
for run in quiet during; do
  echo "$run"
  grep -A2 "min      mean" "$out/$run.txt"
  grep -E "answered|failed" "$out/$run.txt"
done
