#!/usr/bin/env bash
# eval.sh BIN OUT: the recognition rate. Simulated: eight parts taught from 24 views, 200 new
# scenes, the single-view baseline (1 view) and verified. Scanned: the meshes of ../shared/data in
# every case of the experiment, with a report in OUT/report, of which the tables and some plots go
# into docs/experiment.md. Real: the frames and clouds there. Without that folder the last two are
# skipped. The tables go to stdout. TRIALS: scenes for each object and case; with another number
# than 24 the document is not changed.
set -euo pipefail
bin=$(realpath "$1")
out=$2
data=${GRASPDB_SHARED_DATA:-$(dirname "$0")/../../../shared/data}
# Without full rotational symmetry.
scanned_objects=adjustable_wrench,b_lego_duplo,b_toy_airplane,banana,extra_large_clamp,foam_brick
scanned_objects+=,hammer,medium_clamp,nine_hole_peg_test,padlock,pudding_box,wood_block
parts=l-bracket,u-bracket,flange,stepped-block,handle,bracket-left,bracket-right,wedge

rm -rf "$out" && mkdir -p "$out" && out=$(realpath "$out")
source "$(dirname "$0")/../server_process/server.sh"

simulated() {
  echo "== simulated Kinect v2: 8 parts x 24 views taught, 200 scenes, part within 10 cm"
  "$bin/graspdb" simulate --parts "$parts" --step 15 --seed 1 --out "$out/teach" 2>/dev/null
  "$bin/graspdb" simulate --parts "$parts" --random 200 --seed 11 --out "$out/scenes" 2>/dev/null
  start_server "$out/simulated" "$out/simulated.db"
  "$bin/graspdb" import "$out/teach" 2>/dev/null
  for views in 1 20; do
    # The baseline uses the paper's descriptor: the server computes those of all views again.
    local descriptor=gsh288
    [ "$views" != 1 ] || descriptor=mvfh300
    start_server "$out/simulated" "$out/simulated.db" --descriptor "$descriptor"
    echo "{\"pipeline\": {\"verifiedViewCount\": $views}}" >"$out/cell.json"
    "$bin/graspdb" cells set "views-$views" --from "$out/cell.json" >/dev/null
    echo "-- views aligned: $views"
    "$bin/graspdb" recognize "$out/scenes" --split QUERY --cell "views-$views" |
      tee "$out/simulated-$views.txt" | grep -E 'object right'
  done
}

scanned() {
  local meshes=$data/ycb_meshes
  if [ ! -d "$meshes" ]; then
    echo "== scanned objects: skipped, $data is not there"
    return
  fi
  echo "== scanned objects, simulated camera"
  local trials=${TRIALS:-24}
  "$bin/graspdb" eval "$meshes"/*.ply --objects "$scanned_objects" --descriptors --seed 2 \
    --trials "$trials" --out "$out/report" 2>/dev/null
  [ "$trials" != 24 ] || "$(dirname "$0")/document.sh" "$out/report"
}

# Leave-one-out over the clouds of each object; the gravity direction is not given.
turntable() {
  local clouds=$data/vfh_turntable object file role
  if [ ! -d "$clouds" ]; then
    echo "== clouds on a turntable: skipped, $data is not there"
    return
  fi
  echo "== real clouds on a turntable, leave one out"
  mkdir -p "$out/turntable"
  local objects="" captures="" known=" "
  while IFS=, read -r object file role _; do
    [ "$role" = object ] || continue
    local id=article-${object//./-} copy=${file//\//-}
    cp "$clouds/$file" "$out/turntable/$copy"
    [[ $known == *" $id "* ]] ||
      objects+="{\"objectId\":\"$id\",\"stablePoses\":[{\"stablePoseId\":\"upright\"}]},"
    known+="$id "
    captures+="{\"path\":\"$copy\",\"split\":\"TEACH\",\"objectId\":\"$id\",
      \"stablePoseId\":\"upright\",\"segmented\":true},"
  done <"$clouds/index.csv"
  echo "{\"objects\":[${objects%,}],\"captures\":[${captures%,}]}" >"$out/turntable/captures.json"
  local score
  for score in 0 0.5; do
    echo "-- minScore $score"
    "$bin/graspdb" eval "$out/turntable" --leave-one-out --descriptors --min-score "$score" \
      --out "$out/turntable-report-$score" 2>/dev/null
  done
}

# Frames of real cameras, taught from meshes, and simulated cameras with the same errors.
real_cameras() {
  if [ ! -d "$data/real_frames" ]; then
    echo "== frames of real cameras: skipped, $data is not there"
    return
  fi
  echo "== frames of real cameras, taught from meshes"
  "$bin/graspdb" eval "$data/real_frames" 2>/dev/null
  echo "== simulated cameras with the errors of real ones, two scenes of every stable pose"
  local camera cases=
  for camera in kinect-v1 kinect-v2 realsense-d4xx carmine; do
    cases+="real-$camera,real-$camera-hidden-20,real-$camera-hidden-40,"
    cases+="real-$camera-segmented-40,real-$camera-unknown,"
  done
  "$bin/graspdb" eval "$data"/ycb_meshes/*.ply --objects "$scanned_objects" --case "${cases%,}" \
    --seed 2 --trials 2 --out "$out/real-cameras-report" 2>/dev/null
}

real() {
  local frames=$data/realsense_tabletop name
  if [ ! -d "$frames" ]; then
    echo "== real frames: skipped, $data is not there"
    return
  fi
  echo "== RealSense frames without calibration: five objects, the front one named"
  start_server "$out/real" "$out/real.db"
  mkdir -p "$out/real"
  local objects="" captures=""
  for name in blue_mug cylinder green_bowl pepper red_mug; do
    cp "$frames/${name}_object.pcd" "$out/real/$name.pcd"
    local pose
    pose=$("$bin/graspdb" recognize "$frames/$name.pcd" --json |
      sed 's/.*"sensorPose":\({"position":{[^}]*},"orientation":{[^}]*}}\).*/\1/')
    objects+="{\"objectId\":\"$name\",\"stablePoses\":[{\"stablePoseId\":\"upright\"}]},"
    captures+="{\"path\":\"$name.pcd\",\"split\":\"TEACH\",\"objectId\":\"$name\",
      \"stablePoseId\":\"upright\",\"segmented\":true,\"sensorPose\":$pose},"
  done
  echo "{\"objects\":[${objects%,}],\"captures\":[${captures%,}]}" >"$out/real/captures.json"
  "$bin/graspdb" import "$out/real" 2>/dev/null
  "$bin/graspdb" recognize "$frames"/{blue_mug,cylinder,green_bowl,pepper,red_mug}.pcd \
    --pictures "$out/pictures"
}

simulated
scanned
turntable
real
real_cameras
