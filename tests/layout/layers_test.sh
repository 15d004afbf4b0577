#!/usr/bin/env bash
# layers_test.sh SOURCE: whether each folder of sources has its row in the table of docs/architecture.md,
# which lists folders from the bottom up, and includes headers of rows above its own only.
set -euo pipefail
cd "$1"

mapfile -t rows < <(sed -n 's/^| `\([a-z_/]*\)` |.*/\1/p' docs/architecture.md)
declare -A rank
# Another table repeats some of them.
for i in "${!rows[@]}"; do rank[${rows[$i]}]=${rank[${rows[$i]}]-$i}; done

# FILE:#include "PATH" of all sources but the tests'.
includes() {
  grep -rHoE '^#include "[a-z_0-9/]+\.h"' --include='*.h' --include='*.cc' \
    recognition storage program server files rendering pictures client lab | sed 's/#include "//; s/"$//'
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
exit $failed
