#!/usr/bin/env bash
# dockerfile_test.sh SOURCE SERVER: checks that docker/Dockerfile copies the sources of the server's
# build and installs the libraries that the program SERVER is linked with. Builds nothing.
set -euo pipefail
source=$1 server=$2
dockerfile=$source/docker/Dockerfile
context=$(mktemp -d)
trap 'rm -rf "$context"' EXIT

fail() {
  echo "docker/Dockerfile: $*" >&2
  exit 1
}

stage() { awk -v wanted="$1" '/^FROM/ { ++n } n == wanted' "$dockerfile"; }

# Contents of the first stage: the operands of its COPY lines, except the last, the target.
stage 1 | sed -n 's/^COPY //p' | while read -ra operands; do
  for path in "${operands[@]:0:${#operands[@]}-1}"; do cp -r "$source/$path" "$context"; done
done

# Configuring fails where CMakeLists.txt names a folder that is not there.
(cd "$context" && cmake --preset release -DGRASPDB_BUILD_CLIENT=OFF -DGRASPDB_BUILD_TESTS=OFF) \
  >"$context/log" 2>&1 || {
  cat "$context/log"
  fail "copies not all that cmake needs; add the folder to its COPY lines"
}

# So does compiling, where a file of the server includes one that is not there.
grep -rhoE '^#include "[a-z]+/' "$context"/{server,storage,recognition,program} |
  sed 's/.*"\(.*\)\//\1/' | sort -u | while read -r folder; do
  # rocksdb/, absl/ and the like are none of the source's.
  [ ! -d "$source/$folder" ] || [ -d "$context/$folder" ] ||
    fail "does not copy $folder, which the server includes"
done

# The last stage installs the library of every dependency, itself or as one of another package.
runtime=$(stage 2 | sed -n '/apt-get install/,/rm -rf/p' | grep -oE '\blib[a-z0-9+.-]+' | grep -v '^lib$')
# shellcheck disable=SC2086  # several names
provided=$(printf '%s\n' $runtime
  dpkg-query -W -f '${Depends}\n' $runtime | tr ',|' '\n\n' | sed 's/^ *//; s/[ :].*//')
readelf -d "$server" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | while read -r library; do
  path=$(ldconfig -p | sed -n "s/^\t$library (.*x86-64.*) => //p" | head -1)
  package=$(dpkg-query -S "$(realpath "$path")" 2>/dev/null || dpkg-query -S "$path")
  package=${package%%:*}
  grep -qxF "$package" <<<"$provided" || fail "does not install $package for $library"
done
