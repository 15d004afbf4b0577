#!/usr/bin/env bash
# server_options_test.sh SERVER SOURCE: whether the table of docs/handbook.md has each option of the program SERVER, and
# no other.
set -euo pipefail

options() { "$1" --help | grep -oE '^  --[a-z-]+' | grep -v -e --version | tr -d ' ' | sort; }
documented() { sed -n '/^## Tune$/,/^## /s/^| \(`--[^|]*\) |.*/\1/p' "$1/docs/handbook.md" | tr -d '`' | tr -s ', ' '\n' | sort; }

[ -n "$(options "$1")" ]
diff --label docs/handbook.md --label "$1 --help" -u0 <(documented "$2") <(options "$1")
