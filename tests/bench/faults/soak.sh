#!/usr/bin/env bash
# soak.sh BIN OUT SECONDS: a server under mixed traffic: frames of two callers, a bulk import and the
# deletion of its objects in turn, backups, lists, and a watcher. Takes its resident memory and its
# open descriptors every 10 s, into OUT/samples.txt, and prints their growth as Markdown: the slope
# of a straight line through the second half of the samples, when the caches are filled.
set -euo pipefail
bin=$(realpath "$1")
mkdir -p "$2" && out=$(realpath "$2")
seconds=$3
source "$(dirname "$0")/../../server_process/server.sh"

rm -rf "$out/db" "$out/set" "$out/backups"
mkdir "$out/backups"
"$bin/graspdb" simulate --step 30 --seed 3 --out "$out/set" >/dev/null 2>&1
start_server "$out/server" "$out/db" --log-level warn --memory-mib 1024 --backup-dir "$out/backups" \
  --backup-every 60 --backup-keep 3
"$bin/graspdb" import "$out/set" >/dev/null 2>&1
end=$(($(date +%s) + seconds))
: >"$out/calls.txt"

# repeat NAME COMMAND...: until the end; counts the runs that succeeded and failed.
repeat() {
  local name=$1 ok=0 failed=0
  shift
  while [ "$(date +%s)" -lt "$end" ]; do
    if "$@" >/dev/null 2>>"$out/$name.err"; then ok=$((ok + 1)); else failed=$((failed + 1)); fi
  done
  echo "| $name | $ok | $failed |" >>"$out/calls.txt"
}
# The import also succeeds where an earlier one failed after the deletion.
teach_and_delete() {
  local deleted=0
  "$bin/graspdb" objects delete flange --force || deleted=$?
  "$bin/graspdb" import "$out/set" && return "$deleted"
}
watch() { timeout 30 "$bin/graspdb" watch || [ $? = 124 ]; }
read_all() { "$bin/graspdb" objects list && "$bin/graspdb" status && "$bin/graspdb" uploads list; }
back_up() { sleep 5 && "$bin/graspdb" backup list; }

"$bin/graspdb" bench "$out/set" --duration "$seconds" --concurrency 2 >"$out/bench.txt" 2>&1 &
frames=$!
repeat "delete and import" teach_and_delete &
repeat "watch, 30 s" watch &
repeat "lists and status" read_all &
repeat "list of backups" back_up &
: >"$out/samples.txt"
begin=$(date +%s)
while [ "$(date +%s)" -lt "$end" ]; do
  echo "$(($(date +%s) - begin)) $(awk '/VmRSS/ { print $2 }' "/proc/$server/status")" \
    "$(find "/proc/$server/fd" -mindepth 1 | wc -l)" "$(awk '/Threads/ { print $2 }' "/proc/$server/status")" \
    >>"$out/samples.txt"
  sleep 10
done
wait "$frames" || true
while [ "$(wc -l <"$out/calls.txt")" -lt 4 ]; do sleep 1; done

echo "| $seconds s | at the start | in the middle | at the end | at most | growth an hour, second half |"
echo "| --- | --- | --- | --- | --- | --- |"
# column NUMBER NAME UNIT_DIVISOR
column() {
  awk -v c="$1" -v name="$2" -v by="$3" '
    { t[NR] = $1; v[NR] = $c / by; if (v[NR] > most) most = v[NR] }
    END {
      for (i = int(NR / 2) + 1; i <= NR; i++) { n++; st += t[i]; sv += v[i]; stt += t[i] * t[i]; stv += t[i] * v[i] }
      slope = (n * stv - st * sv) / (n * stt - st * st)
      printf "| %s | %.0f | %.0f | %.0f | %.0f | %+.1f |\n", name, v[1], v[int(NR / 2) + 1], v[NR], most, slope * 3600
    }' "$out/samples.txt"
}
column 2 "resident, MiB" 1024
column 3 descriptors 1
column 4 threads 1
printf '\n| calls | succeeded | failed |\n| --- | --- | --- |\n'
sort "$out/calls.txt"
echo
grep -E "answered|p99|RESOURCE|UNAVAIL|INTERNAL" "$out/bench.txt" | head -8
