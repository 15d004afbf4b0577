#!/usr/bin/env bash
# tidy.sh BUILD UNIT...: clang-tidy, but not again for a translation unit that was clean before and
# has not changed since: neither its sources, nor what they include, nor the settings.
set -euo pipefail
build=$1
shift
cache=${XDG_CACHE_HOME:-$HOME/.cache}/graspdb-tidy
mkdir -p "$cache"

# The unit after the preprocessor.
preprocessed() {
  local command
  command=$(awk -v file="$1" '
    /^  "command": / { command = $0 }
    /^  "file": / { if (index($0, "\"" file "\"")) { print command; exit } }' \
    "$build/compile_commands.json" |
    sed 's/^  "command": "//; s/",$//; s/\\"/"/g; s/ -MD -MT [^ ]* -MF [^ ]*//; s/ -o [^ ]* -c / -E -P /')
  (cd "$build" && eval "$command" 2>/dev/null)
}

failed=0
for unit in "$@"; do
  checks=${CHECKS-}
  # The path-sensitive analyser takes three quarters of the time; tests go without it.
  case $unit in */tests/*) checks="$checks,-clang-analyzer-*" ;; esac
  # Comments can switch checks off: the sources count, not only what the preprocessor leaves of them.
  sources=$(sed -n 's/^#include "\(.*\.cc\)"$/\1/p' "$unit")
  # Without the checkout's own path, so that another one finds the same results.
  key=$( (clang-tidy --version; echo "$checks"; cat .clang-tidy "$unit"
    echo "$sources" | xargs -r cat; preprocessed "$unit") | sed "s|$PWD/||g" | sha256sum | cut -d' ' -f1)
  [ -e "$cache/$key" ] && continue
  if clang-tidy --load="$build/own_declarations.so" -p "$build" --quiet --checks="$checks" --extra-arg=-Wno-unknown-warning-option "$unit" 2>/dev/null; then
    touch "$cache/$key"
  else
    echo "tidy.sh: clang-tidy failed on $unit"
    failed=1
  fi
done
exit $failed
