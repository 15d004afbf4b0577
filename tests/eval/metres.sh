#!/usr/bin/env bash
# metres.sh BIN MESHES OUT: converts the workpieces of ../shared/data/industrial_meshes, whose files
# have different units and do not contain them, to meshes in metres in the folder OUT.
set -euo pipefail
bin=$(realpath "$1")
meshes=$2
out=$3
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$out"

convert() { # UNIT FILE...
  local unit=$1
  shift
  "$bin/graspdb" simulate "$@" --unit "$unit" --step 360 --out "$scratch/$unit" >/dev/null 2>&1
  cp "$scratch/$unit"/models/*.ply "$out"
}

convert mm "$meshes"/[01]*.stl "$meshes"/[01]*.STL
convert inch "$meshes"/angle_block.STL "$meshes"/idler_riser.STL
convert m "$meshes"/ADIS16480.STL "$meshes"/octagonal_pocket.stl "$meshes"/ariac/*.stl
