#!/usr/bin/env bash
# never_taught.sh BIN DATA OUT: teaches the meshes of DATA/ycb_meshes and recognises real frames of other objects.
# Prints the segments of each frame and those that were accepted, all of which are wrong.
set -euo pipefail
bin=$(realpath "$1")
data=$(realpath "$2")
mkdir -p "$3" && out=$(realpath "$3")
source "$(dirname "$0")/../server_process/server.sh"
trap stop_server EXIT

rm -rf "$out/db"
start_server "$out/server" "$out/db" --log-level warn
for mesh in "$data"/ycb_meshes/*.ply; do
  "$bin/graspdb" teach "$(basename "$mesh" .ply)" --mesh "$mesh" --unit m >>"$out/teach.txt" 2>&1
done
"$bin/graspdb" status | grep catalogue
# Segments, one object each, are left out.
frames=("$data"/mosd_tabletop/*.pcd "$data"/pcl_samples/milk_cartoon_all_small_clorox.pcd)
for frame in "$data"/realsense_tabletop/*.pcd; do
  [[ $frame == *_object.pcd ]] || frames+=("$frame")
done
"$bin/graspdb" recognize --json --omit-timings "${frames[@]}" >"$out/answers.json"
python3 - "$out/answers.json" <<'PYTHON'
import json
import os
import sys

segments = accepted = 0
for line in open(sys.argv[1]):
    answer = json.loads(line)
    found = answer["response"].get("detections", [])
    named = [d["object"] for d in found if d.get("object")]
    best = max((d.get("score", 0) for d in found), default=0)
    print(f"{os.path.basename(answer['path']):40} {len(found)} segments, best score {best:.2f}", *named)
    segments += len(found)
    accepted += len(named)
print(f"{segments} segments, {accepted} accepted")
PYTHON
