#!/usr/bin/env bash
# Time until data arrives after a program killed with -9 is replaced: a new subscriber of the map receives from a
# running map store, and a running subscriber receives from a new map store.
#
#   tests/bench/restart.sh [ROUNDS]
#
# Over UDP, as by default; with TOPOGEO_DDS_PARTICIPANT=local over shared memory.
set -euo pipefail
rounds=${1:-10}
bin=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../build/bin" && pwd)
work=$(mktemp -d)
partition="restart-$$"
declare -A pids
trap 'kill "${pids[@]}" 2> /dev/null || true; wait; rm -rf "$work"' EXIT

start() {  # NAME PROGRAM [WORDS]
  "$bin/$2" "${@:3}" --partition "$partition" >> "$work/$1" 2> /dev/null &
  pids[$1]=$!
}
kill_now() {  # NAME
  kill -9 "${pids[$1]}"
  wait "${pids[$1]}" 2> /dev/null || true
}
maps() { grep -c '"event":"map"' "$work/living" || true; }  # that the living subscriber has shown
wait_for_maps() { until [ "$(maps)" -ge "$1" ]; do sleep 0.02; done; }  # between two checks
ms_since() { echo $((($(date +%s%N) - $1) / 1000000)); }

start store map_store --out "$work/out"
start living topogeo follow --json
start killed topogeo follow --json
start worker ga_worker --slots 1
wait_for_maps 1
sleep 2  # discovery is over and is not measured
for ((round = 1; round <= rounds; ++round)); do
  kill_now killed
  from=$(date +%s%N)
  "$bin/topogeo" follow --once --partition "$partition" > /dev/null 2>&1
  subscriber=$(ms_since "$from")
  start killed topogeo follow --json
  sleep 1  # it is connected with all
  before=$(maps)
  kill_now store
  from=$(date +%s%N)
  start store map_store --out "$work/out"
  wait_for_maps $((before + 1))
  echo "$round: restarted subscriber $subscriber ms, restarted map store $(ms_since "$from") ms"
  sleep 1  # nothing of this round continues in the next one
done
