#!/usr/bin/env bash
# demo.sh BIN OUT: the main job end to end. Starts a server on an empty database,
# teaches the sample parts from simulated turntable views, shows it new scenes, prints
# how far off the answers are, and draws one picture a scene into OUT/pictures. Then a cell: an
# agent with a simulated camera, and a simulated robot that asks it for picks.
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

say() { printf '\n\033[1m== %s\033[0m\n' "$*"; }

say "a server on an empty database"
start_server "$out/server" "$work/db"
echo "graspdb-server listens on $GRASPDB_SERVER"

say "a simulated Kinect v2 sees sample parts on a turntable, every 15 degrees"
"$bin/graspdb" simulate --parts "$parts" --step 15 --seed "$seed" --out "$work/teach"

say "teaching"
"$bin/graspdb" import "$work/teach"
"$bin/graspdb" objects list

say "the same parts thrown onto the table anew, within 10 cm of the middle"
"$bin/graspdb" simulate --parts "$parts" --random "$scenes" --seed $((seed + 1)) --out "$work/ask"

say "what is it, where, and how is it grasped"
"$bin/graspdb" recognize "$work/ask" --split QUERY --pictures "$out/pictures"

say "pictures (the scan white, the matched view green, the grasp's axes): $out/pictures"
ls "$out/pictures" | head -n 3

say "a cell: its robot stands aside, its agent has a simulated camera"
"$bin/graspdb" cells set demo --robot-base-pose=-0.6,0.2,0.05,0,0,0.342898,0.939373 \
  --region=-0.3,-0.3,-0.02,0.3,0.3,0.4 >"$out/cell.txt"
start_agent "$out/agent" --cell demo --sensor "simulated:scene=$work/table"
echo "graspdb-cell listens for robots on $GRASPDB_AGENT"

say "a robot asks for $picks picks over the Generic Robot Interface"
"$bin/graspdb" robot --cell demo --scene "$work/table" --parts "$parts" --picks "$picks" \
  --seed $((seed + 2))
