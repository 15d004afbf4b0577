#!/usr/bin/env bash
# unused_using.sh FILE...: fails with each using declaration whose name the rest of its file does not
# mention.
set -euo pipefail
awk '
  function report(  i) {
    for (i = 1; i <= count; ++i) {
      if (mentions[names[i]] < 2) { print place[i] ": unused: " line[i]; failed = 1 }
    }
    count = 0
    delete mentions
  }
  FNR == 1 { report() }
  /^ *using [A-Za-z_:]*::[A-Za-z_0-9]+;/ {
    name = $0; sub(/;.*/, "", name); sub(/.*::/, "", name)
    names[++count] = name; place[count] = FILENAME ":" FNR; line[count] = $0
  }
  {
    rest = $0; sub(/ *\/\/.*/, "", rest); n = split(rest, words, /[^A-Za-z_0-9]+/)
    for (i = 1; i <= n; ++i) ++mentions[words[i]]
  }
  END { report(); exit failed }' "$@"
