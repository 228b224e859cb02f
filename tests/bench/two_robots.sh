#!/usr/bin/env bash
# Maps two halves of a log as two robots at the same time into one store: their maps become one when they have seen the
# same place. Leaves the map, its pictures and trajectory.tum in DIR.
#
#   tests/bench/two_robots.sh LOG DIR [RATE] [--ga_worker]
#
# LOG in CARMEN's format, gzip; RATE: times real time. With --ga_worker a search worker helps.
set -euo pipefail
log=${1:?"expected a log"}
out=${2:?"expected a directory"}
rate=${3:-40}
bin=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../build/bin" && pwd)
work=$(mktemp -d)
pids=()
trap 'kill "${pids[@]}" 2> /dev/null || true; rm -rf "$work"' EXIT
export TOPOGEO_DDS_PARTICIPANT=udp_only

start() {  # SERVICE WORDS...
  "$bin/$1" "${@:2}" --partition "two-$$" 2>> "$work/$1.err" &
  pids+=($!)
}

zcat "$log" | grep -E "^(FLASER|ROBOTLASER1) " > "$work/all"
half=$(($(wc -l < "$work/all") / 2))
head -n "$half" "$work/all" > "$work/a.clf"
tail -n +$((half + 1)) "$work/all" > "$work/b.clf"

mkdir -p "$out"
start map_store --out "$out" --new --title "two robots" --robot-id a --with-robots b
start localizer --robot-id a --with-robots b
[ "${4:-}" = "" ] || start ga_worker
for robot in a b; do start local_mapper --robot-id "$robot"; done
sleep 2  # discovery is over and is not measured
for robot in a b; do
  start sensor_gateway --log "$work/$robot.clf" --robot-id "$robot" --rate "$rate"
done
until grep -q "local maps, " "$work/map_store.err"; do
  sleep 0.5  # between two checks
  kill -0 "${pids[@]}" || { cat "$work"/*.err; exit 1; }
done
"$bin/topogeo" store merges --robot-id a --partition "two-$$"
"$bin/topogeo" store info "$out/map.pb"
