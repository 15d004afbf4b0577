#!/usr/bin/env bash
# overload.sh BIN OUT [QUEUE...]: a server at four times its capacity, for each length of its queue.
# Prints a Markdown table: the latency of one caller alone, then that of the answered calls of an open
# loop, and when the rejected ones got their error. Then 200 idle connections, and when a connection
# that sends nothing is closed. Client and server share the machine.
set -euo pipefail
bin=$(realpath "$1")
mkdir -p "$2" && out=$(realpath "$2")
queues=("${@:3}")
[ ${#queues[@]} != 0 ] || queues=(default)
seconds=${SECONDS_OF_LOAD:-20}
source "$(dirname "$0")/../../server_process/server.sh"

[ -d "$out/set" ] || "$bin/graspdb" simulate --step 15 --seed 3 --out "$out/set" >/dev/null 2>&1

# load FLAG...: the report, one line of JSON.
load() { "$bin/graspdb" bench --json --simulate --frames 32 --warmup 40 "$@" 2>/dev/null; }
# value EXPRESSION: of the report on standard input.
value() {
  python3 -c '
import json, sys
r = json.load(sys.stdin)
p = {str(q["percent"]): q["ms"] for q in r["latency"].get("percentiles", [])}
errors = {e["code"]: e for e in r.get("errors", [])}
print(eval(sys.argv[1]))' "$1"
}

echo "| queue | capacity, answers/s | p99 unloaded, ms | sent/s | answered/s | p99 answered, ms | times | rejected | longest until rejected, ms | other errors |"
echo "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
for queue in "${queues[@]}"; do
  flags=(--log-level error)
  [ "$queue" = default ] || flags+=(--queue "$queue")
  rm -rf "$out/db"
  start_server "$out/server" "$out/db" "${flags[@]}"
  "$bin/graspdb" import "$out/set" >/dev/null 2>&1
  load --requests 400 >"$out/alone.json"
  load --requests 800 --concurrency 3 >"$out/capacity.json"
  capacity=$(value 'round(r["answered_per_s"], 1)' <"$out/capacity.json")
  rate=$(python3 -c "print(4 * $capacity)")
  load --rate "$rate" --concurrency 48 --duration "$seconds" >"$out/overload-$queue.json"
  alone=$(value 'round(p["99.0"] if "99.0" in p else p["99"], 1)' <"$out/alone.json")
  value "'| $queue | $capacity | $alone | %.0f | %.0f | %.1f | %.1f | %d | %.0f | %s |' % (
    (r['answered'] + r['failed']) / r['elapsed_s'], r['answered_per_s'],
    p.get('99.0', p.get('99')), p.get('99.0', p.get('99')) / $alone,
    errors.get('RESOURCE_EXHAUSTED', {}).get('count', 0),
    errors.get('RESOURCE_EXHAUSTED', {}).get('longest_ms', 0),
    {c: e['count'] for c, e in errors.items() if c != 'RESOURCE_EXHAUSTED'} or 'none')" <"$out/overload-$queue.json"
done

echo
python3 - "$GRASPDB_SERVER" "$server" <<'PY'
import os, socket, sys, time
host, port = sys.argv[1].rsplit(":", 1)
process = sys.argv[2]

def use():
    with open(f"/proc/{process}/status") as f:
        memory = next(int(line.split()[1]) for line in f if line.startswith("VmRSS"))
    return memory, len(os.listdir(f"/proc/{process}/fd"))

def connect():
    connection = socket.create_connection((host, int(port)))
    return connection

# HTTP/2's preface and an empty SETTINGS frame: a client that is connected, and silent after that.
BEGIN = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + bytes([0, 0, 0, 4, 0, 0, 0, 0, 0])
before = use()
idle = [connect() for _ in range(200)]
for connection in idle:
    connection.sendall(BEGIN)
time.sleep(2)
after = use()
print(f"200 idle connections: {(after[0] - before[0]) / 1024:.1f} MiB, {after[1] - before[1]} descriptors.")

def until_closed(connection, first):
    begin = time.time()
    connection.sendall(first)
    connection.settimeout(150)
    try:
        while connection.recv(4096):
            pass
    except (ConnectionResetError, TimeoutError) as e:
        if isinstance(e, TimeoutError):
            return "not within 150 s"
    return f"after {time.time() - begin:.0f} s"

print("A connection that sends nothing is closed", until_closed(connect(), b"") + ";")
print("one that stops in HTTP/2's preface", until_closed(connect(), BEGIN[:10]) + ";")
print("one that answers no ping", until_closed(connect(), BEGIN) + ".")
PY
