#!/usr/bin/env bash
# renew_block.sh DOCUMENT NAME BLOCK: puts the file BLOCK into DOCUMENT, between the lines that say
# that it is made by NAME.
set -euo pipefail
document=$1 name=$2 block=$3
begin="<!-- begin: made by $name -->"
end="<!-- end: made by $name -->"
grep -qxF -- "$begin" "$document" && grep -qxF -- "$end" "$document" ||
  { echo "$document has lost the lines \"$begin\" and \"$end\"" >&2; exit 1; }
awk -v block="$block" -v begin="$begin" -v end="$end" '
  $0 == begin { print; print ""; while ((getline line < block) > 0) print line; print ""; skip = 1 }
  $0 == end { skip = 0 }
  !skip && $0 != begin { print }' "$document" >"$document.new"
mv "$document.new" "$document"
echo "$document: what is made by $name is renewed"
