#!/usr/bin/env bash
# picks.sh BIN OUT: how many of 500 simulated picks succeed, over all sample parts, and how long a
# robot waits apart from the camera's time. A server, an agent with a simulated camera, and a
# simulated robot as separate processes; the robot uses the Generic Robot Interface.
set -euo pipefail
bin=$(realpath "$1")
out=$2
picks=${PICKS:-500}
seed=${SEED:-11}

mkdir -p "$out" && out=$(realpath "$out")
work=$(mktemp -d)
here=$(dirname "$0")
source "$here/../server_process/server.sh"
source "$here/../server_process/agent.sh"
trap 'stop_agent; stop_server; rm -rf "$work"' EXIT

start_server "$out/server" "$work/db"
"$bin/graspdb" simulate --step "${STEP:-15}" --look-down "${LOOK_DOWN:-40}" --seed "$seed" --out "$work/teach"
"$bin/graspdb" import "$work/teach"
"$bin/graspdb" cells set picks --robot-base-pose=-0.6,0.2,0.05,0,0,0.342898,0.939373 \
  --region=-0.3,-0.3,-0.02,0.3,0.3,0.4 >"$out/cell.txt"
start_agent "$out/agent" --cell picks --sensor "simulated:scene=$work/table"
"$bin/graspdb" robot --cell picks --scene "$work/table" --picks "$picks" --seed $((seed + 1)) \
  "${@:3}" >"$out/picks.txt"
tail -n 1 "$out/picks.txt"
