#!/usr/bin/env bash
# demo.sh BIN OUT: the main job end to end. Starts a server on an empty database,
# teaches the sample parts from simulated turntable views, recognizes new scenes, prints
# the pose errors, and draws one picture a scene into OUT/pictures. Then a cell: an agent with a
# simulated camera, and a simulated robot that requests picks from it. Leaves the database in OUT/db, the
# scenes in OUT/scenes and the requests of the cell in OUT/black-box.
set -euo pipefail
bin=$(realpath "$1")
out=$2
parts=${PARTS:-l-bracket,u-bracket,flange,stepped-block,handle,bracket-left,bracket-right,wedge}
scenes=${SCENES:-16}
seed=${SEED:-2026}
picks=${PICKS:-20}

rm -rf "$out" && mkdir -p "$out" && out=$(realpath "$out")
work=$(mktemp -d)
source "$(dirname "$0")/../server_process/server.sh"
source "$(dirname "$0")/../server_process/agent.sh"
trap 'stop_agent; stop_server; rm -rf "$work"' EXIT

log_step() { printf '\n\033[1m== %s\033[0m\n' "$*"; }

log_step "a server on an empty database"
start_server "$out/server" "$out/db"
echo "graspdb-server listens on $GRASPDB_SERVER"

log_step "capturing sample parts on a turntable with a simulated Kinect v2, every 15 degrees"
"$bin/graspdb" simulate --parts "$parts" --step 15 --seed "$seed" --out "$work/teach"

log_step "teaching"
"$bin/graspdb" import "$work/teach"
"$bin/graspdb" objects list

log_step "random scenes of the same parts, within 10 cm of the centre of the table"
"$bin/graspdb" simulate --parts "$parts" --random "$scenes" --seed $((seed + 1)) --out "$out/scenes"

log_step "recognizing the scenes: objects, poses and grasps"
"$bin/graspdb" recognize "$out/scenes" --split QUERY --pictures "$out/pictures"

log_step "pictures (the scan white, the matched view green, the grasp's axes): $out/pictures"
ls "$out/pictures" | head -n 3

log_step "a cell: a robot beside the table, an agent with a simulated camera"
"$bin/graspdb" cells set demo --robot-base-pose=-0.6,0.2,0.05,0,0,0.342898,0.939373 \
  --region=-0.3,-0.3,-0.02,0.3,0.3,0.4 >"$out/cell.txt"
start_agent "$out/agent" --cell demo --sensor "simulated:scene=$work/table" \
  --black-box "$out/black-box" --black-box-all
echo "graspdb-cell listens for robots on $GRASPDB_AGENT"

log_step "a robot requests $picks picks over the Generic Robot Interface"
"$bin/graspdb" robot --cell demo --scene "$work/table" --parts "$parts" --picks "$picks" \
  --seed $((seed + 2)) --min-percent 90

if [ -x "$bin/graspdb-console" ]; then
  log_step "look at it in a browser: drop a scene of $out/scenes/clouds or a request of $out/black-box on the page"
  echo "$bin/graspdb-server --db $out/db & $bin/graspdb console; kill \$!"
fi
