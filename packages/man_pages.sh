#!/usr/bin/env bash
# man_pages.sh BIN OUT: a man page for each program from its own help, by help2man.
set -euo pipefail
mkdir -p "$2"
page() {
  help2man --no-info --section 1 --no-discard-stderr --name "$2" --output "$out/$1.1" "$bin/$1"
}
bin=$(realpath "$1") out=$(realpath "$2")
page graspdb-server "server that recognises taught objects in depth images"
page graspdb "teach objects to a graspdb server and recognise them"
[ ! -e "$bin/graspdb-console" ] || page graspdb-console "page for browsers that shows a graspdb server"
page graspdb-cell "agent that bridges depth camera, robots and a graspdb server"
