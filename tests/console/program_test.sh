#!/usr/bin/env bash
# program_test.sh BIN: `graspdb console` as a process: its start, its end, and wrong usage.
set -euo pipefail
bin=$1
work=$(mktemp -d)
console=
trap '[ -z "$console" ] || kill "$console" 2>/dev/null || true; rm -rf "$work"' EXIT

fail() {
  echo "$*"
  cat "$work"/* >&2
  exit 1
}

: >"$work/out"
GRASPDB_LISTEN=of-the-server GRASPDB_CONSOLE_LISTEN=127.0.0.1:0 "$bin/graspdb" console --server 127.0.0.1:1 >"$work/out" 2>"$work/err" &
console=$!
url=
while [ -z "$url" ]; do
  kill -0 "$console" 2>/dev/null || fail "it does not start"
  url=$(sed -n 's/^console on //p' "$work/out")
done
curl -sSf "$url" >"$work/page"
grep -q '<script type="module" src="/console.js">' "$work/page" || fail "no page"
curl -sSf --compressed "${url}console.js" >"$work/script"
curl -sS -o "$work/answer" -w '%{http_code}' -H 'Content-Type: application/json' -d '{}' \
  "${url}graspdb.v1.CatalogService/ListObjects" --max-time 30 >"$work/code"
[ "$(cat "$work/code")" = 503 ] || fail "no error without a server"
grep -q "start graspdb-server" "$work/answer" || fail "no advice without a server"

# ends_with STATUS TEXT ARGUMENT...
ends_with() {
  local expected=$1 text=$2 status=0
  shift 2
  "$bin/graspdb" console "$@" >"$work/usage" 2>&1 || status=$?
  [ "$status" = "$expected" ] || fail "status $status instead of $expected: $*"
  grep -q -- "$text" "$work/usage" || fail "no '$text': $*"
}
port=${url##*:}
ends_with 1 "in use" --listen "127.0.0.1:${port%/}"
ends_with 1 "--behind-proxy" --listen 0.0.0.0:0
ends_with 1 "--tls-cert" --listen 127.0.0.1:0 --tls-cert "$work/none" --tls-key "$work/none"
ends_with 2 "HOST:PORT" --listen here
ends_with 2 "give both" --listen 127.0.0.1:0 --tls-cert "$work/none"
ends_with 2 "HOST:PORT" --server nowhere
ends_with 2 "--no-such" --no-such
"$bin/graspdb-console" --help | grep -q -- --behind-proxy || fail "no help without the command's name"

kill -TERM "$console"
status=0
wait "$console" || status=$?
console=
[ "$status" = 0 ] || fail "it ends with $status"
