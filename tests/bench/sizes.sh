#!/usr/bin/env bash
# sizes.sh BIN OUT: memory and disk of a server, and the cost of its backups, by the number of views. Prints two Markdown
# tables and writes them to OUT/sizes.md and OUT/backups.md. VIEWS are the numbers of views.
set -euo pipefail
bin=$(realpath "$1")
mkdir -p "$2" && out=$(realpath "$2")
source "$(dirname "$0")/../server_process/server.sh"

status_mib() { echo "$(($(awk "/$1/ { print \$2 }" "/proc/$server/status") / 1024))"; }
disk_mib() { du -sm --exclude RESERVE "$1" | cut -f 1; }
recognise() { "$bin/graspdb" bench --simulate --frames 32 --verified-views 10 --requests 400 >/dev/null 2>&1; }
empty() {
  stop_server
  rm -rf "$out/db" "$out/peer" "$out/backups" "$out/restored"
  mkdir "$out/backups"
}
# seconds COMMAND...: how long it takes.
seconds() {
  local begin
  begin=$(date +%s%N)
  "$@" >/dev/null
  awk "BEGIN { printf \"%.1f\", ($(date +%s%N) - $begin) / 1e9 }"
}

{
  echo "| catalogue | disk, MiB | resident after the start, MiB | after 400 recognitions | at most |"
  echo "| --- | ---: | ---: | ---: | ---: |"
} | tee "$out/sizes.md"
{
  echo "| views | backup, MiB | first, s | second, without a change, s | verify, s | restore, s |"
  echo "| --- | ---: | ---: | ---: | ---: | ---: |"
} >"$out/backups.md"
for views in ${VIEWS:-1000 10000 100000}; do
  empty
  "$bin/graspdb_fill" "$out/db" "$views" 2>/dev/null
  start_server "$out/server" "$out/db" --log-level warn --backup-dir "$out/backups"
  started=$(status_mib VmRSS)
  recognise
  printf "| %d views of sample parts | %d | %d | %d | %d |\n" "$views" "$(disk_mib "$out/db")" "$started" \
    "$(status_mib VmRSS)" "$(status_mib VmHWM)" | tee -a "$out/sizes.md"
  first=$(seconds "$bin/graspdb" backup create)
  size=$(disk_mib "$out/backups")
  printf "| %d | %d | %s | %s | %s | %s |\n" "$views" "$size" "$first" "$(seconds "$bin/graspdb" backup create)" \
    "$(seconds "$bin/graspdb" backup verify)" \
    "$(seconds "$bin/graspdb-server" backup restore --from "$out/backups" --to "$out/restored")" >>"$out/backups.md"
done
for points in 250 1000; do
  empty
  start_server "$out/server" "$out/db" --log-level warn
  "$bin/graspdb_bulk" "$out/peer" --server "$GRASPDB_SERVER" --views 5000 --points "$points" >/dev/null
  peak=$(status_mib VmHWM)
  start_server "$out/server" "$out/db" --log-level warn
  printf "| 5000 views of %d points, by a bulk upload | %d | %d | | %d |\n" "$points" "$(disk_mib "$out/db")" \
    "$(status_mib VmRSS)" "$peak" | tee -a "$out/sizes.md"
done
empty
cat "$out/backups.md"
