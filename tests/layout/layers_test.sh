#!/usr/bin/env bash
# layers_test.sh SOURCE: whether each folder of sources has its row in the table of docs/architecture.md,
# which lists folders from the bottom up, and includes headers of rows above its own only; and whether any
# includes what docs/architecture.md and CONTRIBUTING.md rule out besides.
set -euo pipefail
cd "$1"

mapfile -t rows < <(sed -n 's/^| `\([a-z_/]*\)` |.*/\1/p' docs/architecture.md)
declare -A rank
# Another table repeats some of them.
for i in "${!rows[@]}"; do rank[${rows[$i]}]=${rank[${rows[$i]}]-$i}; done

# FILE:#include "PATH" of all sources but the tests'.
includes() {
  grep -rHoE '^#include "[a-z_0-9/]+\.h"' --include='*.h' --include='*.cc' \
    base recognition storage program server files rendering pictures client console lab | sed 's/#include "//; s/"$//'
}

failed=0
while IFS=: read -r file header; do
  from=${file%/*} to=${header%/*}
  [ -e "$header" ] || continue # of a library, or generated
  for folder in "$from" "$to"; do
    [ -n "${rank[$folder]-}" ] || { echo "docs/architecture.md: no row for $folder"; failed=1; rank[$folder]=0; }
  done
  if [ "$from" != "$to" ] && [ "${rank[$to]}" -ge "${rank[$from]}" ]; then
    echo "$file includes $header, which is not below it"
    failed=1
  fi
done < <(includes)

# forbid HEADERS FOLDER...: no source there includes a header whose path begins with HEADERS (a Perl pattern).
forbid() {
  local found
  found=$(grep -rnP "^\s*#\s*include\s*[\"<](?:$1)" --include='*.h' --include='*.cc' "${@:2}") || [ $? = 1 ] || failed=1
  [ -n "$found" ] || return 0
  printf '%s\n' "$found"
  echo "${*:2} may not include $1: see docs/architecture.md and CONTRIBUTING.md"
  failed=1
}
forbid '(server|storage)/' client lab
forbid '(server|storage|recognition|rendering)/' console
forbid '(storage|server|files|graspdb|google|grpc|grpcpp)/|\S+\.pb\.h' recognition
forbid 'recognition/' storage
forbid 'program/(?!base/uuid\.h)' storage
forbid 'storage/(?!base/(crc32c|little_endian|folder_sync)\.h)' files
forbid 'files/(?!messages/)' server
forbid 'lab/' recognition program storage server files rendering pictures client console
# Its macros have no prefix; users of the library may have their own of these names.
forbid 'base/' client/sdk/client.h
# Asio of Boost and Asio by itself have the same macros.
forbid 'boost/' recognition program storage server files rendering pictures client lab
forbid 'pcl/' recognition program storage server files rendering pictures client console lab
exit $failed
