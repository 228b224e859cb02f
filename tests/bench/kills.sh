#!/usr/bin/env bash
# Kills each service with -9 ten times at random moments of the simulated drive through the demo floor (topogeo run
# --sim: gateway, emulated laser and base, all services): the map must end complete, its error within 1 cm of that of an
# undisturbed run. The drive is in real time, so no two drives have the same scans and a busy machine loses some:
# besides the row of each drive, the scans that it mapped are recorded and mapped again with nothing killed, which is
# the run to compare with.
#
#   tests/bench/kills.sh OUT [KILLS] [SERVICE...]     ten kills, all services, 4 minutes each
#
# SEED=n chooses other moments. Over UDP: a killed program leaves shared memory behind in which
# others may wait for seconds.
set -euo pipefail
out=${1:?"expected a folder for the results"}
kills=${2:-10}
services=("${@:3}")
[ ${#services[@]} -gt 0 ] ||
  services=(sensor_gateway local_mapper localizer ga_worker_1 map_store planner)
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
bin=${BIN:-$root/build/bin}
world=${WORLD:-$root/share/worlds/floor.world.yaml}
export TOPOGEO_DDS_PARTICIPANT=udp_only
RANDOM=${SEED:-1}
mkdir -p "$out"

drive() {  # NAME: starts a drive
  touch "$out/$1.err"
  local how=()
  # Without a navigator to explore, the simulator drives its tour.
  if [ "$1" = navigator ]; then how=(--explore); fi
  "$bin/topogeo" run --sim "$world" --out "$out/$1" --workers 1 "${how[@]}" \
    --record "$out/$1.clf" > "$out/$1.out" 2> "$out/$1.err" &
  run=$!
}
process() {  # SERVICE: the child of the run with its process
  case $1 in
    ga_worker_1) pgrep -P "$run" -f "/ga_worker .*--name ga_worker_1" ;;
    *) pgrep -P "$run" -x "$1" ;;
  esac
}
row() {  # NAME KILLS: result of a drive
  local corrected stops times
  corrected=$(grep -o 'corrected.*' "$out/$1.out" | head -1 || true)
  stops=$(grep -o '^.*stops.*' "$out/$1.out" | head -1 || true)
  times=$({ grep -o 'at work again after [0-9.]* s' "$out/$1.err" || true; } | awk '
    { n++; sum += $5; if ($5 > most) most = $5 }
    END { if (n) printf "%d times at work again after %.1f s, at most %.1f s", n, sum / n, most }')
  echo "$1: $2 kills; $times; $corrected; $stops"
  [ -s "$out/$1.clf" ] && [ -s "$out/$1/truth.tum" ] || return 0
  "$bin/topogeo" map --log "$out/$1.clf" --out "$out/$1-again" > "$out/$1-again.out" 2>&1 || true
  for map in "$out/$1" "$out/$1-again"; do
    echo "  $(basename "$map"): $("$bin/topogeo" compare "$map/trajectory.tum" "$out/$1/truth.tum" |
      grep -o 'ate.*' | head -1)"
  done
}

if [ ! -s "$out/undisturbed.out" ]; then
  drive undisturbed
  wait "$run" || echo "undisturbed: failed, see $out/undisturbed.err"
fi
row undisturbed 0
for service in "${services[@]}"; do
  drive "$service"
  done=0
  until grep -q 'mapping' "$out/$service.err" || [ "$service" = navigator ]; do sleep 0.2; done  # between two checks
  for ((i = 0; i < kills; ++i)); do
    # A drive takes 200 s on an idle machine: the moments are spread over the first 150.
    sleep "$((150 / kills / 2 + RANDOM % (150 / kills))).$((RANDOM % 1000))"
    kill -0 "$run" 2> /dev/null || break
    pid=$(process "$service") || continue
    kill -9 "$pid" && done=$((done + 1))
  done
  wait "$run" || echo "$service: failed: $(tail -1 "$out/$service.err")"
  row "$service" "$done"
done
