#!/usr/bin/env bash
# Two sites joined by a WireGuard tunnel: nothing else passes between them, discovery servers are at addresses of the
# tunnel, and the map of a log is that of one process to the byte.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
source "$(dirname "${BASH_SOURCE[0]}")/hosts.sh"

need wireguard-go
need wg
need iptables
need_image
[ -c /dev/net/tun ] || skip "there is no /dev/net/tun"
make_log 100 "$work/log.clf"
"$bin/topogeo" map --log "$work/log.clf" --out "$work/alone" > /dev/null 2>&1
chmod 777 "$work"
make_network

servers='10.99.0.1:11811;10.99.0.2:11811'
for host in robot pc1; do
  start_host "$host" -e TOPOGEO_DDS_PARTICIPANT=wan -e ROS_DISCOVERY_SERVER="$servers"
  (umask 077; wg genkey > "$work/$host.key")
  wg pubkey < "$work/$host.key" > "$work/$host.public"
done
process_of() { docker inspect -f '{{ .State.Pid }}' "$network-$1"; }
in_network_of() { nsenter -t "$(process_of "$1")" -n "${@:2}"; }
address_of() { docker inspect -f '{{ range .NetworkSettings.Networks }}{{ .IPAddress }}{{ end }}' "$network-$1"; }

# tunnel HOST ADDRESS PEER ADDRESS_OF_PEER. The name of the interface is also that of a socket of this machine.
tunnel() {
  local name=wg$$${1:0:2}
  nsenter -t "$(process_of "$1")" -n wireguard-go -f "$name" > "$work/$1.wireguard" 2>&1 &
  cleanups+=("kill $!")
  eventually 20 in_network_of "$1" wg show "$name" > /dev/null 2>&1 || { cat "$work/$1.wireguard"; fail "no tunnel"; }
  in_network_of "$1" wg set "$name" listen-port 51820 private-key "$work/$1.key" \
    peer "$(cat "$work/$3.public")" allowed-ips "$4/32" endpoint "$(address_of "$3"):51820"
  in_network_of "$1" ip address add "$2/24" dev "$name"
  in_network_of "$1" ip link set "$name" mtu 1420 up
  in_network_of "$1" iptables -A OUTPUT -o lo -j ACCEPT
  in_network_of "$1" iptables -A OUTPUT -o "$name" -j ACCEPT
  in_network_of "$1" iptables -A OUTPUT -p udp --dport 51820 -j ACCEPT
  in_network_of "$1" iptables -A OUTPUT -j DROP
}

step "a tunnel"
tunnel robot 10.99.0.1 pc1 10.99.0.2
tunnel pc1 10.99.0.2 robot 10.99.0.1

step "a log with a worker at the other site"
start_on robot server fast-discovery-server -i 0 -l 10.99.0.1 -p 11811
start_on pc1 server fast-discovery-server -i 1 -l 10.99.0.2 -p 11811
start_worker pc1
worker_is_there() { [ "$(workers_there)" = 1 ]; }
eventually 60 worker_is_there || { on robot topogeo workers; fail "the worker at the other site is not found"; }
workers=1 start_mapping tunnelled
wait_for_map 180
worker_worked() { [ "$(workers_done)" = 1 ]; }
eventually 20 worker_worked || fail "the worker at the other site had no work"
same_results "$work/tunnelled" "$work/alone"
stop_mapping

step "without the tunnel"
in_network_of pc1 ip link set "wg$$pc" down
cut_off() { ! worker_is_there; }
eventually 60 cut_off || fail "the worker is heard without the tunnel"
step "the end"
