#!/usr/bin/env bash
# Network load of idle participants: N workers of one domain, in a network of their own (needs root), over UDP. Prints
# packets and bytes until all know each other, and in a second afterwards; deploy/SCALING.md plans with these numbers.
#
#   tests/bench/discovery.sh [N...]                     8 16 32 64
#   SERVER=1 tests/bench/discovery.sh [N...]            with a discovery server instead of multicast
set -euo pipefail
[ "$(id -u)" = 0 ] || { echo "needs root, for a network of its own"; exit 1; }
bin=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../build/bin" && pwd)
[ $# -gt 0 ] || set -- 8 16 32 64
export TOPOGEO_DDS_PARTICIPANT=udp_only

counters() { awk '/lo:/ { print $2, $3 }' /proc/net/dev; }  # bytes and packets

one() {  # N: in a network of its own
  ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo
  local before=() settled=() later=() pids=() server=""
  if [ -n "${SERVER:-}" ]; then
    fast-discovery-server -i 0 -l 127.0.0.1 -p 11811 > /dev/null 2>&1 &
    server=$!
    export ROS_DISCOVERY_SERVER=127.0.0.1:11811
    sleep 1  # the server listens
  fi
  read -ra before < <(counters)
  for ((i = 0; i < $1; ++i)); do
    "$bin/ga_worker" --slots 1 --name "w$i" > /dev/null 2>&1 &
    pids+=($!)
  done
  # Until the traffic of two seconds differs by less than a tenth from that of the two seconds before.
  local last=0 now=0 bytes=0
  for ((i = 0; i < 90; ++i)); do
    bytes=$(counters | cut -d' ' -f1)
    sleep 2  # packets of these two seconds are counted
    now=$(($(counters | cut -d' ' -f1) - bytes))
    if [ "$i" -gt 3 ] && [ $((now - last)) -lt $((last / 10)) ] &&
      [ $((last - now)) -lt $((last / 10)) ]; then break; fi
    last=$now
  done
  read -ra settled < <(counters)
  sleep 10  # as above
  read -ra later < <(counters)
  kill "${pids[@]}" $server 2> /dev/null || true
  wait
  local bytes=$((settled[0] - before[0])) packets=$((settled[1] - before[1]))
  awk -v n="$1" -v bytes="$bytes" -v packets="$packets" -v more="$((later[0] - settled[0]))" \
    -v more_packets="$((later[1] - settled[1]))" 'BEGIN {
      printf "| %d | %.2f | %d | %.1f | %.1f | %.0f | %.2f |\n", n, bytes / 1e6, packets,
        bytes / 1e3 / n, more / 1e4, more_packets / 10, more / 1e4 / n }'
}

if [ "${1:-}" = --one ]; then
  one "$2"
  exit
fi
echo "| workers | until all know each other: MB | packets | kB a worker | then kB/s |" \
  "packets/s | kB/s a worker |"
echo "|---|---|---|---|---|---|---|"
for n; do unshare --net "$0" --one "$n"; done
