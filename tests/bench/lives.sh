#!/usr/bin/env bash
# Services that are killed and started again while a log is mapped: all are started by hand, the
# localizer, the map store and the worker are killed with -9 in turn, and the map must be that of
# `topogeo map` to the byte. Prints how long each was away.
#
#   tests/bench/lives.sh LOG [ROUNDS]      LOG as ./run demo leaves it: demo/floor.clf.gz
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
trap 'kill "${pids[@]}" 2> /dev/null || true; rm -rf "$work"' EXIT

start() {
  case $1 in
    map_store) set -- "$1" --out "$work/out" --title lives ;;
    sensor_gateway) set -- "$1" --log "$log" --rate 10 ;;
    ga_worker) set -- "$1" --slots 1 ;;
    *) set -- "$1" --replay ;;
  esac
  "$bin/$1" "${@:2}" --partition "$partition" >> "$work/$1.log" 2>&1 &
  pids[$1]=$!
}
running() {  # SERVICE: its process says that it works
  "$bin/topogeo" status "$1" --partition "$partition" --json 2> /dev/null |
    grep -q "\"process_id\": *${pids[$1]}\b"
}

"$bin/topogeo" map --log "$log" --out "$work/alone" > /dev/null 2>&1
for service in map_store ga_worker localizer local_mapper sensor_gateway; do start $service; done
sleep 3
for ((round = 1; round <= rounds; ++round)); do
  for service in localizer map_store ga_worker; do
    [ -e "$work/out/map.pb" ] && break
    kill -9 "${pids[$service]}"
    wait "${pids[$service]}" 2> /dev/null || true
    from=$(date +%s%N)
    start $service
    until running $service; do sleep 0.05; done
    echo "$service killed, and there again after $((($(date +%s%N) - from) / 1000000)) ms"
    sleep 1
  done
done
until [ -e "$work/out/map.pb" ]; do sleep 0.2; done
"$bin/topogeo" store check "$work/out/map.sqlite"
for file in map.pb trajectory.tum; do
  cmp "$work/alone/$file" "$work/out/$file" && echo "$file: the same bytes as undisturbed"
done
