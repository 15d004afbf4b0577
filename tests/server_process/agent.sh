# To be sourced: a cell's agent for the duration of a script. `bin` is the folder of the binaries.
# shellcheck shell=bash
agent=
stop_agent() {
  [ -z "$agent" ] || { kill "$agent" 2>/dev/null; wait "$agent" 2>/dev/null || true; }
  agent=
}

# start_agent LOGS FLAG...: in place of the previous one, for the server at GRASPDB_SERVER,
# for robots at GRASPDB_AGENT. Its output goes to LOGS.out and LOGS.log.
start_agent() {
  local logs=$1
  stop_agent
  : >"$logs.out"
  "$bin/graspdb-cell" --gri 127.0.0.1:0 --line 127.0.0.1:0 --health 127.0.0.1:0 "${@:2}" \
    >"$logs.out" 2>"$logs.log" &
  agent=$!
  until grep -q '^ready for robots' "$logs.out"; do
    kill -0 "$agent" 2>/dev/null || { cat "$logs.log" >&2; exit 1; }
    sleep 0.01
  done
  GRASPDB_AGENT=$(sed -n 's/^GRI on //p' "$logs.out")
  export GRASPDB_AGENT
}
