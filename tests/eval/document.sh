#!/usr/bin/env bash
# document.sh REPORT: puts the tables and some plots of a report of `graspdb eval` into
# docs/experiment.md, between its markers.
set -euo pipefail
report=$1
tests=$(realpath "$(dirname "$0")/..")
docs=$(realpath "$tests/../docs")

# picture NAME WORDS: embeds a plot of the report, which is copied below.
pictures=()
picture() {
  pictures+=("$1")
  printf '\n![%s](pictures/experiment-%s.svg)\n' "$2" "$1"
}

block=$(mktemp)
trap 'rm -f "$block"' EXIT
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
  picture unknown-precision-and-recall-over-the-minimum-score \
    "Precision and recall over the score, objects that were never taught among them"
  picture unknown-share-of-right-answers-by-score \
    "Reliability: share of right answers by score"
} >"$block"
# First, so that a document without the markers keeps its pictures.
"$tests/document/renew_block.sh" "$docs/experiment.md" "./run eval" "$block"
rm -f "$docs"/pictures/experiment-*.svg
for name in "${pictures[@]}"; do
  cp "$report/figures/$name.svg" "$docs/pictures/experiment-$name.svg"
done
