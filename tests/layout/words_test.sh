#!/usr/bin/env bash
# words_test.sh SOURCE: the project uses the terms of docs/glossary.md; fails where a tracked file has one of the
# words that those terms replaced, one of persons for a program, or a placeholder, or where the
# glossary has more than 40 terms.
set -euo pipefail
cd "$1"
if ! git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
  echo "skipped: needs the git repository"
  exit 77
fi
replaced=(
  'things?' 'likeness' 'parter' 'BudgetCache' 'IndexKeeper' 'CellKeeper' 'kPatience' 'kMost[A-Za-z]*'
  'kLeast[A-Za-z]*' 'least_[a-z_]+' 'least score' 'OrientedColumns' 'GiveWay' 'gives way' 'sharpness' 'attitudes?'
  'mends?' 'doubts?' 'settling' 'pulls' 'held target' 'grasp showing' 'fallen parts' "paper's way" 'houses?'
  'asks?' 'asked' 'tells?' 'told' 'said' 'believes?' 'believed' 'hears?' 'heard' 'nobody' 'somebody' 'anybody' 'lest'
)
pattern=$(IFS='|'; echo "${replaced[*]}")
# Released changes keep their words.
found=$(git grep -n -w -I -E "$pattern" -- . ':!LICENSE' ':!CHANGELOG.md' ':!docs/pictures' \
  ':!tests/layout/words_test.sh' || true)
sight=$(git grep -n -w -I -E 'sights?' -- . ':!CHANGELOG.md' ':!tests/layout/words_test.sh' |
  grep -v 'lines\? of sight' || true)
failed=0
if [ -n "$found$sight" ]; then
  printf '%s\n' "$found" "$sight"
  echo "docs/glossary.md has the terms to use instead"
  failed=1
fi
# Text that was to be filled in later.
if git grep -n -I -E '@@[A-Z]+@@' -- .; then
  echo "replace the placeholder, or delete it"
  failed=1
fi
terms=$(grep -c '^| ' docs/glossary.md) || terms=0
terms=$((terms - 2)) # without the two lines of the header
if [ "$terms" -lt 1 ] || [ "$terms" -gt 40 ]; then
  echo "docs/glossary.md has $terms terms instead of at most 40; explain the others where they are used"
  failed=1
fi
exit $failed
