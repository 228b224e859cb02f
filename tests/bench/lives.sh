#!/usr/bin/env bash
# Services that are killed and started again while a log is mapped: all are started by hand, the localizer, the map
# store and the worker are killed with -9 in turn, and the map must equal that of `topogeo map` to the byte. Prints how
# long each was away. When run as root, the localizer also moves to another machine once: a network namespace with an
# address of its own, with the same map store.
#
#   tests/bench/lives.sh LOG [ROUNDS]      LOG is from ./run demo: demo/floor.clf.gz
#
# Over UDP: a killed program leaves shared memory behind in which others may wait for seconds.
set -euo pipefail
log=${1:?"expected a log"}
rounds=${2:-3}
bin=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../build/bin" && pwd)
work=$(mktemp -d)
partition="lives-$$"
export TOPOGEO_DDS_PARTICIPANT=udp_only
declare -A pids
machine=""  # process that holds the other network namespace
trap 'kill "${pids[@]}" $machine 2> /dev/null || true; rm -rf "$work"' EXIT

other_machine() {  # before any service starts, because services list interfaces only once
  [ "$(id -u)" = 0 ] || return 1
  unshare --net sleep infinity &
  machine=$!
  # Until it has a network of its own.
  until [ "$(readlink "/proc/$machine/ns/net")" != "$(readlink /proc/self/ns/net)" ]; do
    sleep 0.05  # between two checks
  done
  ip link add "lv$$" type veth peer name "lw$$" netns "$machine" || return 1
  ip addr add 10.213.7.1/24 dev "lv$$" && ip link set "lv$$" up
  nsenter -t "$machine" -n sh -c \
    "ip link set lo up; ip addr add 10.213.7.2/24 dev lw$$; ip link set lw$$ up"
}

start() {  # SERVICE [WORDS]: on this machine, or through the command WORDS
  local service=$1 before=("${@:2}")
  set -- "$service"
  case $1 in
    map_store) set -- "$1" --out "$work/out" --title lives ;;
    sensor_gateway) set -- "$1" --log "$log" --rate 10 ;;
    ga_worker) set -- "$1" --slots 1 ;;
    *) set -- "$1" --replay ;;
  esac
  "${before[@]}" "$bin/$1" "${@:2}" --partition "$partition" >> "$work/$1.log" 2>&1 &
  pids[$1]=$!
}
again() {  # SERVICE WHERE [WORDS]: kills it and starts it again
  kill -9 "${pids[$1]}"
  wait "${pids[$1]}" 2> /dev/null || true
  local from
  from=$(date +%s%N)
  start "$1" "${@:3}"
  until running "$1"; do sleep 0.05; done  # between two checks
  echo "$1 killed, and there again$2 after $((($(date +%s%N) - from) / 1000000)) ms"
  sleep 1  # nothing of this life goes on in the next one
}
running() {  # SERVICE: its process reports that it works
  "$bin/topogeo" status "$1" --partition "$partition" --json 2> /dev/null |
    grep -q "\"process_id\": *${pids[$1]}\b"
}

other_machine 2> /dev/null || echo "no other machine: that needs root"
"$bin/topogeo" map --log "$log" --out "$work/alone" > /dev/null 2>&1
for service in map_store ga_worker localizer local_mapper sensor_gateway; do start $service; done
sleep 3  # the map has begun
if [ -n "$machine" ]; then again localizer " on another machine" nsenter -t "$machine" -n; fi
for ((round = 1; round <= rounds; ++round)); do
  for service in localizer map_store ga_worker; do
    [ -e "$work/out/map.pb" ] && break
    again $service ""
  done
done
until [ -e "$work/out/map.pb" ]; do sleep 0.2; done  # between two checks
"$bin/topogeo" store check "$work/out/map.sqlite"
for file in map.pb trajectory.tum; do
  cmp "$work/alone/$file" "$work/out/$file" && echo "$file: the same bytes as undisturbed"
done
