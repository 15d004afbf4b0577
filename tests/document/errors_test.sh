#!/usr/bin/env bash
# errors_test.sh SOURCE: whether the tables of docs/errors.md have each code, reason and status of the server, and no
# other.
set -euo pipefail
cd "$1"

# Names in the first column of a section's table.
documented() { sed -n "/^## $1\$/,/^## /s/^| \`\([A-Z_]*\)\` |.*/\1/p" docs/errors.md | sort; }
# Values of an enum of the contract without the one that is never sent.
values() { sed -n "/^enum $1 {/,/^}/s/^  \([A-Z_]*\) = [1-9][0-9]*;/\1/p" proto/graspdb/v1/recognition.proto | sort; }
# absl::NotFoundError( of the services and the catalogue: NOT_FOUND.
codes() {
  grep -rohE --include='*.cc' 'absl::[A-Za-z]+Error\(' server storage |
    sed 's/absl::\(.*\)Error(/\1/; s/\([a-z]\)\([A-Z]\)/\1_\2/g' | tr '[:lower:]' '[:upper:]' | sort -u
}
# Reasons are literals, the last argument of WithReason.
sources() { grep -rl --include='*.cc' 'WithReason(' server | grep -v '^server/base/errors\.cc$'; }
reasons() { sources | xargs grep -ohE '"[A-Z][A-Z_]+"\)' | tr -d '")' | sort; }

failed=0
# compare SECTION NAMES
compare() {
  [ -n "$2" ] || { echo "the test finds no names for \"$1\" in the sources"; failed=1; }
  diff --label "docs/errors.md, $1" --label "sources" -u0 <(documented "$1") <(sort -u <<<"$2") || failed=1
}
compare Codes "$(codes)"
compare Reasons "$(reasons)"
compare Recognition "$(values RecognitionStatus)"
compare Rejection "$(values RejectionGate)"
uses=$(sources | xargs grep -oh 'WithReason(' | wc -l)
[ "$uses" = "$(reasons | wc -l)" ] || { echo "a use of WithReason() has no literal reason"; failed=1; }
exit $failed
