#!/usr/bin/env bash
# Two sites joined only by a WireGuard tunnel, with discovery servers at its addresses: the map of a log equals that of
# one process to the byte.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
source "$(dirname "${BASH_SOURCE[0]}")/hosts.sh"
source "$(dirname "${BASH_SOURCE[0]}")/tunnel.sh"

need_tunnel
need_image
map_alone 100 "$work/alone"
chmod 777 "$work"
make_network

servers='10.99.0.1:11811;10.99.0.2:11811'
for host in robot pc1; do
  start_host "$host" -e TOPOGEO_DDS_PARTICIPANT=wan -e ROS_DISCOVERY_SERVER="$servers"
  make_tunnel_key "$host"
done
process_of() { docker inspect -f '{{ .State.Pid }}' "$network-$1"; }
enter() { inside=(nsenter -t "$(process_of "$1")" -n); }
address_of() { docker inspect -f '{{ range .NetworkSettings.Networks }}{{ .IPAddress }}{{ end }}' "$network-$1"; }

step "a tunnel"
tunnel robot 10.99.0.1 pc1 10.99.0.2 "$(address_of pc1)"
tunnel pc1 10.99.0.2 robot 10.99.0.1 "$(address_of robot)"

step "a log with a worker at the other site"
start_on robot server fast-discovery-server -i 0 -l 10.99.0.1 -p 11811
start_on pc1 server fast-discovery-server -i 1 -l 10.99.0.2 -p 11811
start_worker pc1
worker_is_there() { [ "$(workers_there)" = 1 ]; }
wait_for "the worker at the other site" worker_is_there || { on robot topogeo workers; fail "the worker at the other site is not found"; }
workers=1 start_mapping tunnelled
wait_for_map
worker_worked() { [ "$(workers_done)" = 1 ]; }
wait_for "work of the worker at the other site" worker_worked || fail "the worker at the other site had no work"
same_results "$work/tunnelled" "$work/alone"
stop_mapping

step "without the tunnel"
enter pc1
"${inside[@]}" ip link set "wg$$pc" down
cut_off() { ! worker_is_there; }
wait_for "the loss of the worker" cut_off || fail "the worker is heard without the tunnel"
step "the end"
