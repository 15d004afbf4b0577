#!/usr/bin/env bash
# units_test.sh PACKAGES: the sandbox of the systemd units, rated from 0 (tight) to 10.
set -euo pipefail
command -v systemd-analyze >/dev/null || { echo "skipped: systemd-analyze is not installed"; exit 77; }
for unit in "$1"/*.service; do
  # In tenths. A unit without any sandbox has 9.6.
  systemd-analyze security --offline=true --no-pager --threshold=20 "$unit" | tail -n 1
done
