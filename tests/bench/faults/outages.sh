#!/usr/bin/env bash
# outages.sh BIN OUT SECONDS...: the time until an agent reaches its server again after outages of SECONDS, with
# TLS. The server runs in a network namespace (root, iproute2, iptables, openssl), and each outage is one of
#   killed  the server is killed, and started again
#   cable   its network interface is down
#   power   no packet in or out, and a new server is there afterwards, which knows no connection
set -euo pipefail
bin=$(realpath "$1")
mkdir -p "$2" && out=$(realpath "$2")
shift 2
space=graspdb-outages
subnet=198.51.100  # reserved for documentation (RFC 5737)
export GRASPDB_SERVER=$subnet.2:50051 GRASPDB_CA=$out/server.pem
agent='' server=''
inside=(ip netns exec "$space")

clean_up() {
  kill $agent $server 2>/dev/null || true
  ip netns del "$space" 2>/dev/null || true
}
trap clean_up EXIT

start_server() {
  "${inside[@]}" "$bin/graspdb-server" --db "$out/db" --listen "$GRASPDB_SERVER" \
    --tls-cert "$out/server.pem" --tls-key "$out/server.key" --log-level warn >"$out/server.out" 2>&1 &
  server=$!
}
# "ip netns exec" replaces itself by the server.
kill_server() { kill -9 "$server"; wait "$server" 2>/dev/null || true; }
begin() {
  case $1 in
    killed) kill_server ;;
    cable) "${inside[@]}" ip link set inner down ;;
    power)
      "${inside[@]}" iptables -A INPUT ! -i lo -j DROP
      "${inside[@]}" iptables -A OUTPUT ! -o lo -j DROP
      kill_server ;;
  esac
}
end() {
  case $1 in
    killed) start_server ;;
    cable) "${inside[@]}" ip link set inner up ;;
    power)
      start_server
      sleep 2  # it starts, which is not measured here
      "${inside[@]}" iptables -F ;;
  esac
}
# wait_for EVENT LINE: in the agent's log, after that line.
wait_for() {
  until tail -n +"$(($2 + 1))" "$out/agent.log" | grep -q "event=$1"; do
    kill -0 "$agent"
    sleep 0.02
  done
}

ip netns add "$space"
ip link add outer type veth peer name inner netns "$space"
ip address add $subnet.1/30 dev outer
ip link set outer up
"${inside[@]}" ip address add $subnet.2/30 dev inner
"${inside[@]}" ip link set inner up
"${inside[@]}" ip link set lo up
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 1 -subj /CN=outages \
  -addext "subjectAltName=IP:$subnet.2" -keyout "$out/server.key" -out "$out/server.pem" 2>/dev/null
rm -rf "$out/db" "$out/table"
"$bin/graspdb" simulate --random 1 --seed 1 --out "$out/table" >/dev/null 2>&1
start_server
until "$bin/graspdb" cells set demo --robot-base-pose=0,0,0,0,0,0,1 >"$out/cell.txt" 2>&1; do sleep 0.1; done
"$bin/graspdb-cell" --cell demo --sensor "files:$out/table" --gri "" --line 127.0.0.1:0 --health "" \
  --cell-period 0.1 2>"$out/agent.log" &
agent=$!
wait_for server_there 0

echo "| outage | seconds | until the agent notices it, s | after it, until it is connected, s |"
echo "| --- | --- | --- | --- |"
for seconds in "$@"; do
  for outage in killed cable power; do
    lines=$(wc -l <"$out/agent.log")
    begun=$(date +%s%N)
    begin "$outage"
    sleep "$seconds"
    end "$outage"
    ended=$(date +%s%N)
    wait_for server_there "$lines"
    now=$(date +%s%N)
    lost=$(tail -n +$((lines + 1)) "$out/agent.log" | sed -n '/event=server_lost/{s/^time=\([^ ]*\).*/\1/p;q}')
    awk -v outage="$outage" -v seconds="$seconds" -v begun="$begun" -v lost="$(date -d "$lost" +%s%N)" \
      -v ended="$ended" -v now="$now" \
      'BEGIN { printf "| %s | %s | %.1f | %.1f |\n", outage, seconds, (lost - begun) / 1e9, (now - ended) / 1e9 }'
  done
done
