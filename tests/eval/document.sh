#!/usr/bin/env bash
# document.sh REPORT: puts the tables and some plots of a report of `graspdb eval` into
# docs/experiment.md, between the lines that say so.
set -euo pipefail
report=$1
docs=$(realpath "$(dirname "$0")/../../docs")
document=$docs/experiment.md
begin="<!-- begin: made by ./run eval -->"
end="<!-- end: made by ./run eval -->"
grep -qxF -- "$begin" "$document" && grep -qxF -- "$end" "$document" ||
  { echo "$document has lost the lines \"$begin\" and \"$end\"" >&2; exit 1; }

# picture NAME WORDS: a plot of the report, copied and shown.
picture() {
  cp "$report/figures/$1.svg" "$docs/pictures/experiment-$1.svg"
  printf '\n![%s](pictures/experiment-%s.svg)\n' "$2" "$1"
}

block=$(mktemp)
trap 'rm -f "$block"' EXIT
rm -f "$docs"/pictures/experiment-*.svg
{
  cat "$report/cases.md"
  printf '\nDescriptors alone, on the paper'"'"'s protocol:\n\n'
  cat "$report/descriptors.md"
  picture descriptors-false-recognition-for-each-object-and-descriptor \
    "False recognition for each object and descriptor (figure 12 of the paper)"
  picture paper-mean-absolute-rotation-error-for-each-object \
    "Rotation error of the paper's protocol (figure 13)"
  picture paper-mean-absolute-translation-error-for-each-object \
    "Translation error of the paper's protocol (figure 13)"
  picture everything-recall-over-the-add-s-that-is-allowed \
    "Recall over the pose error that is allowed, everything at once"
  picture unknown-precision-and-recall-over-the-least-score \
    "Precision and recall over the score, things that were never taught among them"
  picture unknown-share-of-right-answers-by-score \
    "What a score is worth: share of right answers by score, with things that were never taught"
} >"$block"
awk -v block="$block" -v begin="$begin" -v end="$end" '
  $0 == begin { print; print ""; while ((getline line < block) > 0) print line; print ""; skip = 1 }
  $0 == end { skip = 0 }
  !skip && $0 != begin { print }' "$document" >"$document.new"
mv "$document.new" "$document"
echo "$document: tables and plots renewed"
