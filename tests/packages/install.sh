#!/usr/bin/env bash
# install.sh ROOT PACKAGES [BEFORE]: installs the Debian packages of the folder PACKAGES in ROOT, a Debian 12
# in a folder (debootstrap), as an administrator does, and prints what was checked. BEFORE is a folder with
# packages of an earlier version, to upgrade from. Needs root; starts the units' command lines, not systemd.
set -euo pipefail
root=${1:?install.sh ROOT PACKAGES [BEFORE]}
packages=${2:?install.sh ROOT PACKAGES [BEFORE]}
before=${3:-$packages}

here() { chroot "$root" "$@"; }
checked() { printf 'ok: %s\n' "$*"; }
install_from() {
  rm -rf "$root/packages"
  cp -r "$1" "$root/packages"
  installs /packages/graspdb-server_*.deb /packages/graspdb-client_*.deb
}
installs() {
  here sh -c "DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $*" >"$root/install.log" 2>&1 ||
    { tail -n 20 "$root/install.log"; return 1; }
}
command_of() { sed -n 's/^ExecStart=//p' "$root/lib/systemd/system/$1.service"; }

server=
cell=
console=
start() {
  install -d -o "$(here id -u graspdb)" -g "$(here id -g graspdb)" -m 700 "$root/var/lib/graspdb"  # StateDirectory
  : >"$root/server.out"
  # Not by here(): $! would be a shell that waits for the server.
  # shellcheck disable=SC2046  # words of a command
  chroot "$root" setpriv --reuid graspdb --regid graspdb --clear-groups $(command_of graspdb-server) >"$root/server.out" 2>"$root/server.log" &
  server=$!
  for _ in $(seq 300); do
    grep -q "listening on" "$root/server.out" && return
    kill -0 "$server" 2>/dev/null || break
    sleep 0.1
  done
  cat "$root/server.log"
  return 1
}
stop() {
  kill "$server"
  wait "$server"
  server=
}
# Programs find those beside them by /proc/self/exe.
own_proc=
mountpoint -q "$root/proc" || { mount -t proc proc "$root/proc"; own_proc=$root/proc; }
trap '[ -z "$cell" ] || kill "$cell" 2>/dev/null; [ -z "$console" ] || kill "$console" 2>/dev/null; [ -z "$server" ] || stop; [ -z "$own_proc" ] || umount "$own_proc"' EXIT

here sh -c 'apt-get update -q' >/dev/null
install_from "$before"
checked "installed $(here dpkg-query -W -f '${Package} ${Version}, ' graspdb-server graspdb-client)"
start
here graspdb status >/dev/null
checked "the unit's command line serves as user graspdb: $(command_of graspdb-server)"
here sh -c 'cd /tmp && rm -rf teach scene && graspdb simulate --parts l-bracket,flange --step 30 --out teach >/dev/null 2>&1 &&
  graspdb simulate --parts flange --random 1 --seed 7 --out scene >/dev/null 2>&1 && graspdb import teach >/dev/null 2>&1'
here sh -c 'graspdb --json recognize /tmp/scene/clouds/*.pcd' | grep -q '"objects/flange"'
checked "the client teaches two parts and recognizes one"
stop

if [ "$before" != "$packages" ]; then
  echo "# a line of the administrator" >>"$root/etc/graspdb/server.conf"
  install_from "$packages"
  grep -q "a line of the administrator" "$root/etc/graspdb/server.conf"
  start
  here sh -c 'graspdb --json recognize /tmp/scene/clouds/*.pcd' | grep -q '"objects/flange"'
  checked "upgraded to $(here dpkg-query -W -f '${Version}' graspdb-server): settings kept, parts taught before are recognized"
  stop
fi

start
installs /packages/graspdb-cell_*.deb
here graspdb cells set demo --robot-base-pose=0,0,0,0,0,0,1 >/dev/null
sed 's/"NAME"/"demo"/; s/"openni2"/"files:\/tmp\/scene"/' "$root/usr/share/doc/graspdb-cell/examples/cell.conf" >"$root/etc/graspdb/cell-demo.conf"
# shellcheck disable=SC2046  # words of a command
chroot "$root" setpriv --reuid 65534 --regid 65534 --clear-groups $(command_of graspdb-cell@ | sed s/%i/demo/) >"$root/cell.log" 2>&1 &
cell=$!
for _ in $(seq 100); do
  here graspdb-cell health >/dev/null 2>&1 && break
  sleep 0.1
done
here graspdb-cell health >/dev/null || { cat "$root/cell.log"; exit 1; }
kill "$cell"
checked "the agent's unit serves with its settings: $(command_of graspdb-cell@)"

installs /packages/graspdb-console_*.deb curl
chroot "$root" setpriv --reuid 65534 --regid 65534 --clear-groups graspdb console --listen 127.0.0.1:18080 >"$root/console.out" 2>&1 &
console=$!
for _ in $(seq 100); do
  grep -q "console on" "$root/console.out" && break
  sleep 0.1
done
here curl -sSf http://127.0.0.1:18080/console.js >"$root/console.js"
here curl -sSf -H 'Content-Type: application/json' -d '{}' http://127.0.0.1:18080/graspdb.v1.CatalogService/ListObjects | grep -q objects/flange
kill "$console"
checked "the console serves its page and forwards calls"

installs /packages/libgraspdb-dev_*.deb cmake g++ make man-db
rm -rf "$root/example" && cp -r "$(dirname "$0")/../../examples/04-your-own-client" "$root/example"
here sh -c 'cmake -S /example/cpp -B /example/build && cmake --build /example/build' >"$root/install.log" 2>&1 ||
  { tail -n 20 "$root/install.log"; exit 1; }
here graspdb teach box --mesh /example/box.ply --unit mm >/dev/null 2>&1
here /example/build/recognize | grep -q "objects/box"
checked "a C++ program builds with libgraspdb-dev and recognizes a box"
installs /packages/python3-graspdb_*.deb
here /usr/bin/python3 /example/python/recognize.py | grep -q "objects/box"
checked "a Python program with python3-graspdb recognizes it"
stop

here man -w graspdb-server graspdb graspdb-cell graspdb-console >/dev/null
checked "man pages"
here sh -c 'apt-get purge -q -y graspdb-server graspdb-client graspdb-cell graspdb-console libgraspdb-dev python3-graspdb' >"$root/install.log" 2>&1
[ -e "$root/var/lib/graspdb/db/CURRENT" ] && [ ! -e "$root/usr/bin/graspdb-server" ] && [ ! -e "$root/etc/graspdb/server.conf" ]
checked "purged; the database in /var/lib/graspdb stays"
