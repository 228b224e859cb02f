#!/usr/bin/env bash
# A robot and two PCs in network namespaces, behind a switch that does a fault to their packets; or a process
# freezes, or clocks step. Needs root. Prints a row for each fault.
#
# Mapping of a log: the robot has the gateway and the local mapper, pc1 the localizer and a worker, pc2 the map
# store and a worker. Wall time; recovery after the fault (until the map store has stored another stop); whether
# the map is that of `topogeo map` to the byte.
#
# Driving ("drive ..."): the robot, a simulated one, has the gateway and the navigator, pc1 all else. Time until it
# stands after the fault; recovery until it drives again; whether it arrives, or drives on, without a collision. Where
# the navigator freezes the goal is given up, so it stays where it is. "drive flood": pc2 sends packets of strangers to
# both; the largest memory of a service stands in place of the recovery.
#
#   tests/bench/faults.sh [BUILD] [FAULT...]     all faults: about eight minutes
#   tests/bench/faults.sh build "loss 5" "cut pc1" "drive cut"
[ $# -gt 0 ] || set -- "$(dirname "${BASH_SOURCE[0]}")/../../build"
source "$(dirname "${BASH_SOURCE[0]}")/../container/common.sh"
source "$(dirname "${BASH_SOURCE[0]}")/../faults/hosts.sh"
shift
scans=300
cut_s=10
# The navigator stands when its pose is 3 s old, the gateway when a command is 0.5 s old. Braking takes a second; two
# more are for a machine that has other work.
most_to_stand_ms=6000
most_when_frozen_ms=3500
most_memory_mb=150
faults=("$@")
[ $# -gt 0 ] || faults=(none "loss 1" "loss 5" "loss 20" "delay 100" "reorder 10" "duplicate 20" "cut robot"
  "cut pc1" "cut pc2" "freeze worker" "clock robot" "clock pc1" "clock pc2"
  "drive none" "drive loss" "drive cut" "drive frozen" "drive flood")

need_programs
need python3
make_hosts
make_log "$scans" "$work/log.clf"
"$bin/topogeo" map --log "$work/log.clf" --out "$work/alone" > /dev/null 2>&1

# Stops of the map that are stored for good.
stored() {
  python3 - "$out/map.sqlite" 2> /dev/null << 'END' || echo 0
import sqlite3, sys
print(sqlite3.connect("file:%s?mode=ro" % sys.argv[1], uri=True, timeout=5).execute(
    "SELECT count(*) FROM map_stop").fetchone()[0])
END
}
more_stored_than() { [ "$(stored)" -gt "$1" ]; }
run_ended() { [ -e "$out/trajectory.tum" ] && [ -e "$out/map.pb" ]; }

start_run() {
  start_on pc2 map_store "$bin/map_store" --out "$out" --title log.clf
  start_on pc1 worker1 "$bin/ga_worker" --slots 1 --name pc1
  start_on pc2 worker2 "$bin/ga_worker" --slots 1 --name pc2
  start_on pc1 localizer "$bin/localizer" --replay --wait-workers 2 --wait-seconds 10
  start_on robot local_mapper "$bin/local_mapper" --replay
  # What happens once needs a run that lasts longer than it.
  local rate=10
  case $fault in "cut "* | "freeze "* | "clock "*) rate=4 ;; esac
  start_on robot sensor_gateway "$bin/sensor_gateway" --log "$work/log.clf" --rate "$rate"
}

# What is done when the run is on its way; sets `recovery`.
disturb() {  # FAULT
  local before end
  recovery=-
  case $1 in
    "cut "*)
      network "$1"
      sleep "$cut_s"
      before=$(stored)
      network "join ${1#cut }"
      ;;
    "freeze worker")
      before=$(stored)
      kill -STOP "${pids[worker1]}"
      ;;
    "clock "*)
      # Forward by an hour, back by two: both signs.
      before=$(stored)
      step_clock "${1#clock }" +3600
      sleep 2
      step_clock "${1#clock }" -3600
      ;;
    *) return 0 ;;
  esac
  run_ended && { recovery="ended before"; return 0; }
  end=$(now_ms)
  eventually 60 more_stored_than "$before" || run_ended || { recovery=never; return 0; }
  recovery="$(($(now_ms) - end)) ms"
}

# ---- driving

start_drive() {
  "$bin/topogeo" config --devices | sed "/^laser:/,/^base:/ { s|^  port: .*|  port: $out/laser|; s|^  kind: .*|  kind: pls|; }
    /^base:/,\$ { s|^  port: .*|  port: $out/base|; s|^  dialect: .*|  dialect: binary|; }" > "$out/devices.yaml"
  start_on robot simulator "$bin/simulator" --world "$source_dir/tests/data/floor.world.yaml" \
    --laser-port "$out/laser" --base-port "$out/base"
  start_on robot drive_watch "$build/tests/drive_watch"
  start_on robot navigator "$bin/navigator"
  start_on robot local_mapper "$bin/local_mapper" --standalone
  start_on pc1 map_store "$bin/map_store" --map "$work/floor/map.pb"
  start_on pc1 planner "$bin/planner"
  start_on pc1 localizer "$bin/localizer" --map "$work/floor/map.pb" --initial-pose 0,0,0
  eventually 10 test -e "$out/base" || fail "the simulator does not start"
  start_on robot sensor_gateway "$bin/sensor_gateway" --devices "$out/devices.yaml"
  # Twenty metres along the first drive.
  local goal
  goal=$(awk '{ if (NR > 1) way += sqrt(($2 - x) ^ 2 + ($3 - y) ^ 2); x = $2; y = $3
    if (way > 20) { print x "," y; exit } }' "$work/floor/trajectory.tum")
  start_on robot goto "$bin/topogeo" goto "$goal" --patience 60 --wait-seconds 30
}

drives() { tail -n 1 "$work/drive_watch.log" 2> /dev/null | awk '{ exit !($2 > 0.2) }'; }
stands() {  # half a second long: ground truth comes 20 times a second
  tail -n 10 "$work/drive_watch.log" | awk '$2 > 0.005 || $3 > 0.005 { exit 1 }'
}
arrived() { grep -qs "^arrived" "$work/goto.log"; }
stood_after() {  # MS: milliseconds until it stood for good
  awk -v from="$1" '$1 > from { if ($2 > 0.005 || $3 > 0.005) last = $1 } END { print last ? last - from : 0 }' \
    "$work/drive_watch.log"
}

largest_memory_mb() {
  local name
  for name in "${!pids[@]}"; do
    awk '/^VmHWM/ { print int($2 / 1024) }' "/proc/${pids[$name]}/status" 2> /dev/null
  done | sort -n | tail -n 1
}

drive() {  # FAULT; sets took, recovery and equal
  local victim from most
  took=-
  recovery=-
  equal="no: does not drive"
  start_drive
  eventually 60 drives || return 0
  sleep 3
  case $1 in
    none) ;;
    loss) network loss 20 ;;
    flood) start_on pc2 stranger_flood "$build/tests/stranger_flood" 10.213.8.1 10.213.8.2 ;;
    cut | frozen)
      most=$most_to_stand_ms
      from=$(now_ms)
      if [ "$1" = cut ]; then
        network cut robot
      else
        victim=${pids[navigator]}
        most=$most_when_frozen_ms
        kill -STOP "$victim"
      fi
      sleep "$cut_s"
      equal="no: does not stand"
      stands || return 0
      took=$(stood_after "$from")
      equal="no: stands after $took ms"
      [ "$took" -le $most ] || return 0
      took="stands after $took ms"
      if [ "$1" = cut ]; then
        from=$(now_ms)
        network join robot
        equal="no: does not drive on"
        eventually 60 drives || return 0
        recovery="$(($(now_ms) - from)) ms"
      fi
      ;;
  esac
  if [ "$1" = none ] || [ "$1" = loss ] || [ "$1" = flood ]; then
    equal="no: does not arrive"
    eventually 120 arrived || return 0
  fi
  if [ "$1" = flood ]; then
    recovery="$(largest_memory_mb) MB"
    equal="no: takes $recovery"
    [ "$(largest_memory_mb)" -le $most_memory_mb ] || return 0
  fi
  equal="no: $(awk 'END { print $4 }' "$work/drive_watch.log") collisions"
  [ "$equal" != "no: 0 collisions" ] || equal=yes
}

end_run() {
  network clear
  [ "$equal" = yes ] || failed=1
  local service kept=$work/log$run_number
  for service in "${!pids[@]}"; do stop "$service"; done
  mkdir "$kept"
  mv "$work"/*.log "$kept"
  cp "$kept/switch.log" "$work"
}

failed=0
run_number=0
printf '| fault | wall time, s | recovery | result equal |\n|---|---|---|---|\n'
for fault in "${faults[@]}"; do
  run_number=$((run_number + 1))
  out=$work/run$run_number
  recovery=-
  network clear
  stepping=""
  case $fault in
    "clock "*)
      stepping=$(find /usr/lib -name libfaketimeMT.so.1 2> /dev/null | head -n 1)
      [ -n "$stepping" ] || { echo "| $fault | - | faketime is not installed | - |"; continue; }
      for host in "${hosts[@]}"; do step_clock "$host" +0; done
      ;;
    none | "cut "* | "freeze "* | "drive "*) ;;
    *) network "$fault" ;;
  esac
  mkdir -p "$out"
  if [ "${fault%% *}" = drive ]; then
    [ -e "$work/floor/map.pb" ] || {
      make_log 100000 "$work/floor.clf"
      "$bin/topogeo" map --log "$work/floor.clf" --out "$work/floor" > /dev/null 2>&1
    }
    drive "${fault#drive }"
    printf '| %s | %s | %s | %s |\n' "$fault" "$took" "$recovery" "$equal"
    end_run
    continue
  fi
  from=$(now_ms)
  start_run
  if ! eventually 60 more_stored_than 5; then
    recovery="no stop is stored"
  else
    disturb "$fault"
  fi
  equal=yes
  eventually 120 run_ended || equal="no: does not end"
  took=$((($(now_ms) - from) / 100))
  if [ "$equal" = yes ]; then
    for file in map.pb trajectory.tum; do
      cmp -s "$out/$file" "$work/alone/$file" || equal="no: $file"
    done
  fi
  printf '| %s | %d.%d | %s | %s |\n' "$fault" $((took / 10)) $((took % 10)) "$recovery" "$equal"
  end_run
done
[ $failed = 0 ] || fail "a result differs from that of one process, or the robot does not stand"
