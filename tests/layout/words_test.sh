#!/usr/bin/env bash
# words_test.sh SOURCE: the project uses the terms of docs/glossary.md; fails where a tracked file, or its name, has
# one of the words that those terms replaced, one of persons for a program, or a placeholder, or where the
# glossary has more than 40 terms.
set -euo pipefail
cd "$1"
if ! git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
  echo "skipped: needs the git repository"
  exit 77
fi
# Anywhere, in any case: no other word has these letters.
anywhere=(
  'likeness' 'budget_?cache' 'index_?keeper' 'cell_?keeper' 'patience' 'patiently' 'hopeless' 'attitude' 'sharpness'
  'oriented_?columns' 'give_?way' 'gives way' 'err_?together' 'catches_?up' 'gone_?with_?table' 'in_sight'
  'seek_?beginning' 'only_?beginning' 'plan_?questions' 'hold_?changes' 'least score' 'held target'
  'grasp showing' "paper's way"
)
# As a word or a part of a snake_case name, small or with a capital.
parts=(
  'things?' 'parter' 'mends?' 'doubts?' 'settling' 'pulls' 'houses?' 'asks?' 'asked' 'tells?' 'told' 'said'
  'believes?' 'believed' 'hears?' 'heard' 'nobody' 'somebody' 'anybody' 'lest' 'fallen'
)
# Within a CamelCase name, where a capital begins a part.
capitals=(
  'Things?' 'Parter' 'Mends?' 'Doubts?' 'Asks?' 'Asked' 'Tells?' 'Told' 'Said' 'Says' 'Believes?' 'Hears?' 'Heard'
  'Knows' 'Wants' 'Fallen' 'Sure'
)
starts=('kMost' 'kLeast' 'least_[a-z]+' 'Knows\(')

any_of() { local IFS='|'; echo "($*)"; }
initials() { printf '%s\n' "$@" | sed -E 's/^(.)/[\U\1\L\1]/'; } # asked -> [Aa]sked
# matching OPTION PATTERN: the lines of all files, and the names of files. Released changes keep their words.
matching() {
  git grep -n -I "$1" -e "$2" -- . ':!LICENSE' ':!CHANGELOG.md' ':!docs/pictures' ':!tests/layout/words_test.sh' || [ $? = 1 ]
  git ls-files | grep "$1" -e "$2" | sed 's/$/: its name/' || true
}
mapfile -t parts < <(initials "${parts[@]}")
# The contract keeps the name of its field asked_view_count; a score may have fallen by some amount.
found=$(
  matching -Ei "$(any_of "${anywhere[@]}")"
  matching -E "(^|[^A-Za-z])$(any_of "${parts[@]}")([^a-z]|\$)|[a-z0-9]$(any_of "${capitals[@]}")([^a-z]|\$)"
  matching -E "(^|[^A-Za-z0-9_])$(any_of "${starts[@]}")"
)
found=$(grep -v 'asked_view_count\|askedViewCount\|fallen by' <<<"$found" || true)
# Not in names of files, since a decision record may describe what it replaced.
sight=$(git grep -n -I -E '(^|[^A-Za-z])[Ss]ights?([^a-z]|$)|[a-z0-9]Sights?([^a-z]|$)' -- . ':!CHANGELOG.md' \
  ':!tests/layout/words_test.sh' | grep -vi 'lines\? of sight' || true)
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
