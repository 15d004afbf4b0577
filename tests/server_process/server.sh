# To be sourced: a server for the duration of a script. `bin` is the folder of the binaries.
# shellcheck shell=bash
server=
stop_server() {
  [ -z "$server" ] || { kill "$server" 2>/dev/null; wait "$server" 2>/dev/null || true; }
  server=
}
trap stop_server EXIT

# start_server LOGS DATABASE FLAG...: in place of the previous one, at GRASPDB_SERVER, on a free
# port or at `listen`. Its output goes to LOGS.out and LOGS.log.
start_server() {
  local logs=$1 database=$2
  stop_server
  : >"$logs.out"
  "$bin/graspdb-server" --db "$database" --listen "${listen:-127.0.0.1:0}" "${@:3}" \
    >"$logs.out" 2>"$logs.log" &
  server=$!
  until grep -q '^listening on ' "$logs.out"; do
    kill -0 "$server" 2>/dev/null || { cat "$logs.log" >&2; exit 1; }
    sleep 0.01
  done
  GRASPDB_SERVER=$(sed -n 's/^listening on //p' "$logs.out")
  export GRASPDB_SERVER
}
