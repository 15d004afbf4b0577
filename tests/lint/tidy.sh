#!/usr/bin/env bash
# tidy.sh BUILD FILE...: clang-tidy, but not again for a file that was clean before and has
# not changed since: neither itself, nor what it includes, nor the settings.
set -euo pipefail
build=$1
shift
cache=${XDG_CACHE_HOME:-$HOME/.cache}/graspdb-tidy
mkdir -p "$cache"

# What the compiler sees of a file.
preprocessed() {
  local command
  command=$(awk -v file="$PWD/$1" '
    /^  "command": / { command = $0 }
    /^  "file": / { if (index($0, "\"" file "\"")) { print command; exit } }' \
    "$build/compile_commands.json" |
    sed 's/^  "command": "//; s/",$//; s/\\"/"/g; s/ -MD -MT [^ ]* -MF [^ ]*//; s/ -o [^ ]* -c / -E -P /')
  (cd "$build" && eval "$command" 2>/dev/null)
}

failed=0
for file in "$@"; do
  # What needs a library that is not there, such as a camera's, is not compiled.
  grep -q "^  \"file\": \"$PWD/$file\"" "$build/compile_commands.json" || continue
  key=$( (clang-tidy --version; echo "${CHECKS-}"; cat .clang-tidy tests/.clang-tidy; cat "$file"; preprocessed "$file") |
    sha256sum | cut -d' ' -f1)
  [ -e "$cache/$key" ] && continue
  if clang-tidy --load="$build/own_declarations.so" -p "$build" --quiet --checks="${CHECKS-}" --extra-arg=-Wno-unknown-warning-option "$file" 2>/dev/null; then
    touch "$cache/$key"
  else
    failed=1
  fi
done
exit $failed
