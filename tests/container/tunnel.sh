#!/usr/bin/env bash
# shellcheck disable=SC2154  # common.sh sets work
# A WireGuard tunnel between two sites. Scripts that source this define `enter SITE`, which sets `inside` to the command
# prefix for the network of a site.

# need_tunnel: skips the test when a tunnel cannot be made.
need_tunnel() {
  need wireguard-go wg iptables
  [ -c /dev/net/tun ] || skip "there is no /dev/net/tun" "mkdir -p /dev/net && mknod /dev/net/tun c 10 200"
}

make_tunnel_key() {  # SITE
  (umask 077; wg genkey > "$work/$1.key")
  wg pubkey < "$work/$1.key" > "$work/$1.public"
}

has_interface() { "${inside[@]}" wg show "$1" > /dev/null 2>&1; }

# tunnel SITE ADDRESS PEER ADDRESS_OF_PEER ENDPOINT: afterwards only tunnel traffic leaves the site. The interface's
# name is unique, because it also names a socket of this machine.
tunnel() {
  local interface=wg$$${1:0:2} inside
  enter "$1"
  "${inside[@]}" wireguard-go -f "$interface" > "$work/$1.wireguard" 2>&1 &
  cleanups+=("kill $!")
  wait_for "the tunnel of $1" has_interface "$interface" ||
    { cat "$work/$1.wireguard"; fail "no tunnel"; }
  "${inside[@]}" wg set "$interface" listen-port 51820 private-key "$work/$1.key" \
    peer "$(cat "$work/$3.public")" allowed-ips "$4/32" endpoint "$5:51820"
  "${inside[@]}" ip address add "$2/24" dev "$interface"
  "${inside[@]}" ip link set "$interface" mtu 1420 up
  "${inside[@]}" iptables -A OUTPUT -o lo -j ACCEPT
  "${inside[@]}" iptables -A OUTPUT -o "$interface" -j ACCEPT
  "${inside[@]}" iptables -A OUTPUT -p udp --dport 51820 -j ACCEPT
  "${inside[@]}" iptables -A OUTPUT -j DROP
}
