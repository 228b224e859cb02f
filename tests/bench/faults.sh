#!/usr/bin/env bash
# A robot and two PCs in network namespaces, behind a switch that applies one or several faults to their packets ("loss
# 20, reorder 10"); or a process freezes, or clocks step. Needs root. Prints a row for each fault.
#
# Mapping of a log: the robot has the gateway and the local mapper, pc1 the localizer and a worker, pc2 the map store
# and a worker. Prints the wall time, the recovery time after the fault (until the map store has stored another stop),
# and whether the map equals that of `topogeo map` to the byte.
#
# Driving ("drive ..."): the simulated robot has the gateway and the navigator, pc1 all other services. A fault of the
# network or a clock begins while the robot drives on; then the robot is cut off, and joined again with the fault still
# active. Prints the times until it stops and until it drives again, the time of the whole drive, and collisions. When
# the navigator freezes, the goal is given up and the robot stays where it is. Strangers on pc2: "drive flood" sends
# packets to both, "drive absurd" samples of absurd content on all topics, "drive topics" ever new topics, "drive
# strangers" all three at once; the row has the largest memory of a service.
#
# "secured ..." is the same with certificates, and the profile for links between sites.
#
# The result of a row depends on the events and their order. Durations count only with --limits, on a machine that does
# nothing else.
#
#   tests/bench/faults.sh [BUILD [--limits] [FAULT...]]     all faults: about fifteen minutes
#   tests/bench/faults.sh build "loss 5" "cut pc1" "drive cut"
[ $# -gt 0 ] || set -- "$(dirname "${BASH_SOURCE[0]}")/../../build"
source "$(dirname "${BASH_SOURCE[0]}")/../container/common.sh"
source "$(dirname "${BASH_SOURCE[0]}")/../faults/hosts.sh"
shift
limits=""
[ "${1:-}" != --limits ] || { limits=1; shift; }
scans=300
cut_s=10  # duration of a cut; during it nothing is expected
# Limits of a drive. The navigator stops when its pose is 3 s old, the gateway when a command is 0.5 s old. Braking
# takes a second; two more allow for other load on the machine.
most_to_stand_ms=6000
most_when_frozen_ms=3500
most_memory_mb=150
three_seconds=60  # of the world: the simulator publishes the ground truth 20 times a second
faults=("$@")
[ $# -gt 0 ] || faults=(none "loss 1" "loss 5" "loss 20" "delay 100" "reorder 10" "duplicate 20" "cut robot"
  "cut pc1" "cut pc2" "freeze worker" "clock robot" "clock pc1" "clock pc2"
  "secured none" "secured loss 5" "secured loss 20" "secured cut robot" "secured cut pc1" "secured cut pc2"
  "drive none" "drive frozen" "drive cut" "drive delay 100" "drive reorder 10" "drive duplicate 20" "drive loss 20"
  "drive clock robot" "drive clock pc1"
  "drive flood" "drive absurd" "drive topics" "drive strangers")

need_programs
need python3
make_hosts

# Number of stops in the stored map.
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
  start_on pc1 localizer "$bin/localizer" --replay --wait-workers 2 --wait-seconds "$hang_limit_s"
  start_on robot local_mapper "$bin/local_mapper" --replay
  start_on robot sensor_gateway "$bin/sensor_gateway" --log "$work/log.clf" --rate "$rate"
}

# Injects the fault during the run and sets `recovery`. Fails when the run has ended before the fault was over.
disturb() {  # FAULT
  local before end
  recovery=-
  wait_for "the first stops of the map" more_stored_than 5 || { recovery="no stop is stored"; return 0; }
  case $1 in
    "cut "*)
      network "$1"
      sleep "$cut_s"  # the link is cut for so long
      before=$(stored)
      network "join ${1#cut }"
      ;;
    "freeze worker")
      kill -STOP "${pids[worker1]}"
      before=$(stored)
      ;;
    "clock "*)
      step_clock_to_and_fro "${1#clock }"
      before=$(stored)
      ;;
    *) return 0 ;;
  esac
  ! run_ended || return 1
  end=$(now_ms)
  wait_for "another stop of the map" more_stored_or_ended "$before" || { recovery=never; return 0; }
  recovery="$(($(now_ms) - end)) ms"
}
more_stored_or_ended() { more_stored_than "$1" || run_ended; }

# Forward by an hour, back by two: both signs. faketime reads the file once a second; a process that misses the first
# step gets the second.
step_clock_to_and_fro() {  # HOST
  step_clock "$1" +3600
  sleep 2  # services work with the wrong time
  step_clock "$1" -3600
  sleep 2  # the second step takes effect before anything else
}

# map_with FAULT: maps the log to its end; sets recovery and took.
map_with() {
  local from
  from=$(now_ms)
  start_run
  disturb "$1" || return 1
  result=yes
  wait_for "the end of the run" run_ended || result="no: does not end"
  took=$((($(now_ms) - from) / 100))
}

# ---- driving

start_drive() {  # METRES
  "$bin/topogeo" config --devices | sed "/^laser:/,/^base:/ { s|^  port: .*|  port: $out/laser|; s|^  kind: .*|  kind: pls|; }
    /^base:/,\$ { s|^  port: .*|  port: $out/base|; s|^  dialect: .*|  dialect: binary|; }" > "$out/devices.yaml"
  # The simulator and its watcher keep the real clock.
  stepping="" start_on robot simulator "$bin/simulator" --world "$source_dir/share/worlds/floor.world.yaml" \
    --laser-port "$out/laser" --base-port "$out/base"
  stepping="" start_on robot drive_watch "$build/tests/drive_watch" --log-level off
  start_on robot navigator "$bin/navigator"
  start_on robot local_mapper "$bin/local_mapper" --standalone
  start_on pc1 map_store "$bin/map_store" --map "$work/floor/map.pb"
  start_on pc1 planner "$bin/planner"
  start_on pc1 localizer "$bin/localizer" --map "$work/floor/map.pb" --initial-pose 0,0,0
  wait_for "the ports of the simulator" test -e "$out/base" || fail "the simulator does not start"
  start_on robot sensor_gateway "$bin/sensor_gateway" --devices "$out/devices.yaml"
  # The goal is a point of the first drive: the one at that distance from its start.
  goal=$(awk -v least="$1" '{ if (NR > 1) way += sqrt(($2 - x) ^ 2 + ($3 - y) ^ 2); x = $2; y = $3
    if (way > least) { print x "," y; exit } }' "$work/floor/trajectory.tum")
  send_goal
}
send_goal() {
  stop goto
  start_on robot goto "$bin/topogeo" goto "$goal" "${patient[@]}"
}

drives() { tail -n 1 "$work/drive_watch.log" 2> /dev/null | awk '{ exit !($2 > 0.2) }'; }
# Whether it has stood still for COUNT ground truths since line SINCE.
stands() {  # SINCE COUNT
  tail -n "+$(($1 + 1))" "$work/drive_watch.log" | tail -n "$2" |
    awk -v count="$2" '$2 > 0.005 || $3 > 0.005 { moves = 1 } END { exit moves || NR < count }'
}
truths() { wc -l < "$work/drive_watch.log"; }
# Whether it has driven for COUNT ground truths since line SINCE, or has arrived.
has_driven() {  # SINCE COUNT
  tail -n "+$(($1 + 1))" "$work/drive_watch.log" | awk -v count="$2" '$2 > 0.2 { ++n } END { exit n < count }' || goto_ended
}
arrived() { grep -qs "^arrived" "$work/goto.log"; }
goto_ended() { arrived || ! kill -0 "${pids[goto]}" 2> /dev/null; }
stood_after() {  # MS: milliseconds until it stood for good
  awk -v from="$1" '$1 > from { if ($2 > 0.005 || $3 > 0.005) last = $1 } END { print last ? last - from : 0 }' \
    "$work/drive_watch.log"
}

largest_memory_mb() {
  local name
  for name in "${!pids[@]}"; do
    [ "${name%%_*}" != stranger ] || continue
    awk '/^VmHWM/ { print int($2 / 1024) }' "/proc/${pids[$name]}/status" 2> /dev/null
  done | sort -n | tail -n 1
}

# Counter that each kind of stranger raises in services: packets, samples, topics.
declare -A counted_as=([flood]=invalid_packet [absurd]=invalid_sample [topics]=unknown_topic)

start_stranger() {  # flood, absurd or topics
  case $1 in
    flood) start_on pc2 stranger_flood "$build/tests/stranger_flood" 10.213.8.1 10.213.8.2 ;;
    *) start_on pc2 "stranger_$1" "$build/tests/stranger_samples" "$1" ;;
  esac
}

# Whether the navigator (the guard runs beside it) has counted all these: otherwise no data of a stranger reached the
# robot. The order of arrival of several strangers is unknown.
counted() {  # REASON...
  on robot "$bin/topogeo" status navigator --json --wait-seconds 20 2> /dev/null | python3 -c 'import json, sys
counts = {}
for service in json.load(sys.stdin):
    counts.update(service["faults"], **service["drops"])
sys.exit(not all(reason in counts for reason in sys.argv[1:]))' "$@"
}

collisions() { awk 'END { print $4 }' "$work/drive_watch.log"; }

# Each sets `result` until its condition is met.
must_stand() {  # MOST_MS SINCE_MS
  result="no: does not stand"
  # For good: it may stop for a moment for another reason.
  wait_for "the robot to stand for three seconds of the world" stands "$(truths)" $three_seconds || return 1
  stood=$(stood_after "$2")
  result="no: stands after $stood ms"
  [ -z "$limits" ] || [ "$stood" -le "$1" ] || return 1
  stood="$stood ms"
}
must_drive() {
  result="no: does not drive on"
  wait_for "the robot to drive" drives
}
must_drive_on() {  # for three seconds of the world
  result="no: does not drive on"
  wait_for "three seconds of driving" has_driven "$(truths)" $three_seconds
}
must_arrive() {
  local line
  result="no: does not arrive"
  until arrived; do
    line=$(truths)
    # Speed does not matter: it hangs when it has not moved for the whole hang limit.
    if wait_for "the robot at its goal" goto_ended; then
      arrived || gave_up_for_time || return 1
      arrived || send_goal
    else
      has_moved "$line" || return 1
    fi
  done
  arrival="$((($(now_ms) - started) / 1000)) s"
}
has_moved() { tail -n "+$(($1 + 1))" "$work/drive_watch.log" | awk '$2 > 0.005 { ++n } END { exit !n }'; }  # SINCE
# A navigator that was silent for ten seconds counts as gone, though it goes on when the machine is only busy.
gave_up_for_time() { tail -n 1 "$work/goto.log" | grep -q 'the navigator is gone\|the navigator does not take the goal'; }

cut_off() {
  must_drive || return 1
  local from
  from=$(now_ms)
  network cut robot
  must_stand $most_to_stand_ms "$from" || return 1
  from=$(now_ms)
  network join robot
  must_drive || return 1
  drove_on="$(($(now_ms) - from)) ms"
}

meet_strangers() {  # NAME...
  local stranger reasons=()
  for stranger in "$@"; do
    start_stranger "$stranger"
    reasons+=("${counted_as[$stranger]}")
  done
  must_arrive || return 1
  result="no: not all counted: ${reasons[*]}"
  wait_for "counts of ${reasons[*]}" counted "${reasons[@]}" || return 1
  memory=$(largest_memory_mb)
  result="no: takes $memory MB"
  [ "$memory" -le $most_memory_mb ] || return 1
  memory="$memory MB"
}

drive() {  # FAULT; sets stood, drove_on, arrival, memory and result
  local started
  stood=- drove_on=- arrival=- memory=-
  result="no: does not drive"
  case $1 in
    # Among strangers the robot drives slowly, since they keep all cores busy.
    flood | absurd | topics | strangers) start_drive 5 ;;
    *) start_drive 20 ;;
  esac
  wait_for "the robot to drive" drives || return 0
  started=$(now_ms)
  must_drive_on || return 0
  case $1 in
    none) must_arrive || return 0 ;;
    frozen)
      kill -STOP "${pids[navigator]}"
      must_stand $most_when_frozen_ms "$(now_ms)" || return 0
      ;;
    flood | absurd | topics) meet_strangers "$1" || return 0 ;;
    strangers) meet_strangers flood absurd topics || return 0 ;;
    *)
      case $1 in
        cut) ;;
        "clock "*) step_clock_to_and_fro "${1#clock }" ;;
        *) network_faults "$1" ;;
      esac
      must_drive_on || return 0
      cut_off && must_arrive || return 0
      ;;
  esac
  result="no: $(collisions) collisions"
  [ "$(collisions)" != 0 ] || result=yes
}

end_run() {
  network clear
  [ "$result" = yes ] || failed=1
  local service kept=$work/log$run_number
  for service in "${!pids[@]}"; do stop "$service"; done
  mkdir "$kept"
  mv "$work"/*.log "$kept"
  cp "$kept/switch.log" "$work"
}

print_head() {  # KIND: begins another table
  [ "$kind" != "$1" ] || return 0
  [ -z "$kind" ] || echo
  kind=$1
  case $kind in
    map) printf '| fault | wall time, s | recovery | result equal |\n|---|---|---|---|\n' ;;
    drive) printf '| fault | stands after | drives on after | drive | memory | as expected |\n|---|---|---|---|---|---|\n' ;;
  esac
}

profile=$TOPOGEO_DDS_PARTICIPANT
secure() {
  [ -d "$work/keys" ] || "$source_dir/deploy/security/make_keys" "$work/keys" issue --robot robot robot > "$work/make_keys.out" 2>&1 ||
    fail "make_keys: $(tail -n 1 "$work/make_keys.out")"
  export TOPOGEO_SECURITY=$work/keys/robot TOPOGEO_DDS_PARTICIPANT=wan
}

network_faults() {  # FAULT, FAULT...
  local parts part
  IFS=, read -ra parts <<< "$1"
  for part in "${parts[@]}"; do network "${part# }"; done
}

failed=0
run_number=0
kind=""
for name in "${faults[@]}"; do
  fault=${name#secured }
  unset TOPOGEO_SECURITY
  TOPOGEO_DDS_PARTICIPANT=$profile
  [ "$fault" = "$name" ] || secure
  run_number=$((run_number + 1))
  out=$work/run$run_number
  recovery=-
  network clear
  stepping=""
  case $fault in
    "clock "* | "drive clock "*)
      stepping=$(find /usr/lib -name libfaketimeMT.so.1 2> /dev/null | head -n 1)
      if [ -z "$stepping" ]; then
        # deploy/packages.txt lists it: CI must not leave the row out silently.
        [ "${CI:-}" != true ] || fail "$fault: faketime is not installed"
        echo "| $name: left out, faketime is not installed |"
        continue
      fi
      for host in "${hosts[@]}"; do step_clock "$host" +0; done
      ;;
    none | "cut "* | "freeze "* | "drive "*) ;;
    *) network_faults "$fault" ;;
  esac
  mkdir -p "$out"
  if [ "${fault%% *}" = drive ]; then
    [ -e "$work/floor" ] || map_alone 100000 "$work/floor"
    drive "${fault#drive }"
    print_head drive
    printf '| %s | %s | %s | %s | %s | %s |\n' "$name" "$stood" "$drove_on" "$arrival" "$memory" "$result"
    end_run
    continue
  fi
  [ -e "$work/alone" ] || map_alone "$scans" "$work/alone"
  make_log "$scans" "$work/log.clf"
  # A single event needs a run that outlasts it: when the run ends first, it is repeated at half the speed.
  case $fault in "cut "*) rate=4 ;; "freeze "* | "clock "*) rate=8 ;; *) rate=lossless ;; esac
  until map_with "$fault"; do
    rate=$(awk -v rate="$rate" 'BEGIN { print rate / 2 }')
    echo "the run ended before '$fault' was over: again, at $rate times the speed of the robot"
    for service in "${!pids[@]}"; do stop "$service"; done
    network clear
    rm -rf "$out"
    mkdir -p "$out"
  done
  if [ "$result" = yes ]; then
    for file in map.pb trajectory.tum; do
      cmp -s "$out/$file" "$work/alone/$file" || result="no: $file"
    done
  fi
  print_head map
  printf '| %s | %d.%d | %s | %s |\n' "$name" $((took / 10)) $((took % 10)) "$recovery" "$result"
  end_run
done
[ $failed = 0 ] || fail "a result differs from that of one process, or the robot does not stand"
