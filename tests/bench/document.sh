#!/usr/bin/env bash
# document.sh RATIOS: puts the table of a whole run of graspdb_bench into docs/performance.md,
# between the lines that say so.
set -euo pipefail
table=$1
document=$(realpath "$(dirname "$0")/../../docs")/performance.md
begin="<!-- begin: made by ./run bench -->"
end="<!-- end: made by ./run bench -->"
grep -qxF -- "$begin" "$document" && grep -qxF -- "$end" "$document" ||
  { echo "$document has lost the lines \"$begin\" and \"$end\"" >&2; exit 1; }
awk -v block="$table" -v begin="$begin" -v end="$end" '
  $0 == begin { print; print ""; while ((getline line < block) > 0) print line; print ""; skip = 1 }
  $0 == end { skip = 0 }
  !skip && $0 != begin { print }' "$document" >"$document.new"
mv "$document.new" "$document"
echo "$document: table renewed"
