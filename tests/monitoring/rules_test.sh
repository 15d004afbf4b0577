#!/usr/bin/env bash
# rules_test.sh MONITORING: Prometheus can read the configuration and the alerts, and each alert fires.
set -euo pipefail
command -v promtool >/dev/null || { echo "skipped: there is no promtool; ./run test unpacks it"; exit 77; }
cd "$1"
promtool check config prometheus.yml
promtool check rules alerts.yml
promtool test rules alerts_test.yml
