#!/usr/bin/env bash
# Hosts as network namespaces behind a switch with faults (faulty_switch.cpp). Sourced after
# ../container/common.sh, which sets bin, build and work. The hosts share the disk, not the network.
# shellcheck disable=SC2154

hosts=(robot pc1 pc2)
declare -A pids=()
export TOPOGEO_DDS_PARTICIPANT=${TOPOGEO_DDS_PARTICIPANT:-udp_only}

# Whether the switch is ready, or has ended.
switch_answers() { grep -qs ready "$work/switch.log" || ! kill -0 "$1" 2> /dev/null; }  # PID

# Skips the test when the kernel or the user's rights do not permit it.
make_hosts() {
  need ip nsenter
  [ "$(id -u)" = 0 ] || skip "namespaces need root" root
  [ -c /dev/net/tun ] || skip "there is no /dev/net/tun" "mkdir -p /dev/net && mknod /dev/net/tun c 10 200"
  [ -x "$build/tests/faulty_switch" ] || skip "faulty_switch is not built" "ninja -C build faulty_switch"
  unshare --net true 2> /dev/null || skip "no network namespace can be made" "root, with CAP_SYS_ADMIN in a container,"
  mkfifo "$work/orders"
  exec {orders}<> "$work/orders"
  unshare --net "$build/tests/faulty_switch" "${hosts[@]}" < "$work/orders" > "$work/switch.log" 2>&1 &
  local middle=$! host number=0
  cleanups+=("kill $middle")
  wait_for "the switch" switch_answers "$middle" || fail "the switch does not start"
  grep -qs ready "$work/switch.log" || skip "no TAP device: $(cat "$work/switch.log")" "root, with CAP_NET_ADMIN in a container,"
  for host in "${hosts[@]}"; do
    number=$((number + 1))
    local space=topogeo-$$-$host
    ip netns add "$space"
    cleanups+=("ip netns del $space")
    nsenter -t $middle -n ip link set "$host" netns "$space"
    ip -n "$space" link set "$host" name eth0
    ip -n "$space" address add 10.213.8.$number/24 dev eth0
    ip -n "$space" link set lo up
    ip -n "$space" link set eth0 up
    ip -n "$space" route add 224.0.0.0/4 dev eth0
  done
  cleanups+=(stop_all)
}

network() { printf '%s\n' "$*" >&"$orders"; }  # an order to the switch

on() {  # HOST COMMAND...
  nsenter --net="/run/netns/topogeo-$$-$1" "${@:2}"
}

# start_on HOST NAME COMMAND...: starts it in the background; output in $work/NAME.log. When the clock of a host may
# step, faketime reads it from a file.
start_on() {
  local host=$1 name=$2 clock=()
  shift 2
  if [ -n "${stepping:-}" ]; then
    clock=(env LD_PRELOAD="$stepping" FAKETIME_TIMESTAMP_FILE="$work/$host.clock"
      FAKETIME_DONT_FAKE_MONOTONIC=1 FAKETIME_CACHE_DURATION=1 FAKETIME_FORCE_MONOTONIC_FIX=0)
  fi
  nsenter --net="/run/netns/topogeo-$$-$host" "${clock[@]}" "$@" >> "$work/$name.log" 2>&1 &
  pids[$name]=$!
}

step_clock() { printf '%s\n' "$2" > "$work/$1.clock"; }  # HOST OFFSET, for example +3600

stop() {  # NAME [SIGNAL]: waits until it is gone
  local pid=${pids[$1]:-}
  [ -n "$pid" ] || return 0
  unset "pids[$1]"
  kill -CONT "$pid" 2> /dev/null || true
  kill -"${2:-TERM}" "$pid" 2> /dev/null || true
  wait "$pid" 2> /dev/null || true
}

stop_all() {
  local name
  for name in "${!pids[@]}"; do kill -CONT "${pids[$name]}" 2> /dev/null || true; stop "$name" KILL; done
}
