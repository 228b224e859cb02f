#!/usr/bin/env bash
# Hosts as containers on a bridge network, for the tests of this folder. Sourced after common.sh.
# shellcheck disable=SC2154  # common.sh sets them

network=topogeo-test-$$

make_network() {
  claim_domain
  docker network create "$network" > /dev/null
  cleanups+=("docker network rm $network")
  # shellcheck disable=SC2016  # expanded when it runs
  keepers+=('for name in $(docker ps -a --filter "name=$network-" --format "{{ .Names }}"); do
    docker logs "$name" > "$work/${name#"$network"-}.container.log" 2>&1; done')
}

# start_host NAME [OPTIONS]: a container that waits for `run_on`. A service goes on after it stood still on a busy
# machine, because nothing would start it again.
start_host() {
  local host=$1
  shift
  docker run -d --rm --name "$network-$host" --hostname "$host" --network "$network" --network-alias "$host" \
    --init --no-healthcheck -e TOPOGEO_DDS_PARTICIPANT=udp_only -e TOPOGEO_DOMAIN -e TOPOGEO_LONGEST_FREEZE_S=0 \
    -v "$work:/exchange" --user root "$@" "$image" sleep infinity > /dev/null
  cleanups+=("docker rm -f $network-$host")
}

on() {  # HOST COMMAND...
  docker exec "$network-$1" "${@:2}"
}

# start_on HOST NAME COMMAND...: starts it in the background; output in $work/log/HOST.NAME.
start_on() {
  mkdir -p "$work/log"
  # shellcheck disable=SC2016
  docker exec -d "$network-$1" sh -c 'echo $$ > "/run/$1.pid"; log=/exchange/log/$(hostname).$1; shift
    exec "$@" >> "$log" 2>&1' sh "${@:2}"
}

# shellcheck disable=SC2016
is_gone_on() { on "$1" sh -c '! kill -0 "$(cat "/run/$1.pid")" 2> /dev/null' sh "$2"; }  # HOST NAME

# kill_on HOST NAME [SIGNAL]: waits until it is gone.
kill_on() {
  # shellcheck disable=SC2016
  on "$1" sh -c 'pid=$(cat "/run/$1.pid"); kill -"$2" "$pid"' sh "$2" "${3:-9}" || return 1
  wait_for "the end of $2 on $1" is_gone_on "$@" || fail "$2 on $1 does not end"
}

is_lost() { ! docker inspect "$network-$1" > /dev/null 2>&1; }  # HOST

# lose_host NAME: kills everything on it at once, like a power failure; only $work is left. start_host makes it again.
lose_host() {
  local containers
  mapfile -t containers < <(docker ps --format '{{ .Names }}' | grep -E "^$network-$1(-|\$)")
  docker kill "${containers[@]}" > /dev/null
  docker rm -f "${containers[@]}" > /dev/null 2>&1 || true
  wait_for "the end of the containers of $1" is_lost "$1" || fail "the host $1 stays"
}

no_multicast_on() {  # HOST
  local pid
  pid=$(docker inspect -f '{{ .State.Pid }}' "$network-$1")
  nsenter -t "$pid" -n iptables -A OUTPUT -d 224.0.0.0/4 -j DROP
}

# has_dropped_on HOST COUNT: whether so many packets were dropped since no_multicast_on.
has_dropped_on() {
  local pid
  pid=$(docker inspect -f '{{ .State.Pid }}' "$network-$1")
  nsenter -t "$pid" -n iptables -nvxL OUTPUT | awk -v least="$2" '$3 == "DROP" && $1 >= least { found = 1 } END { exit !found }'
}

# Number of stops that the run has stored.
stops_stored() {
  python3 - "$work/$run/map.sqlite" 2> /dev/null << 'END' || echo 0
import sqlite3, sys
print(sqlite3.connect("file:%s?mode=ro" % sys.argv[1], uri=True).execute("SELECT count(*) FROM map_stop").fetchone()[0])
END
}
more_stops_than() { [ "$(stops_stored)" -gt "$1" ] || [ -e "$work/$run/map.pb" ]; }

# count_workers LEAST: number of workers in the output of `topogeo workers` that have done so many tasks.
count_workers() { awk -v least="$1" '$4 == "%" && $5 ~ /^[0-9]+$/ && $5 >= least' | wc -l; }
# Number of workers that have done a task, and of all workers.
workers_done() { on robot topogeo workers 2> /dev/null | count_workers 1; }
workers_there() { on robot topogeo workers 2> /dev/null | count_workers 0; }

start_worker() { start_on "$1" ga_worker ga_worker --slots 1 --name "$1"; }

start_service() {  # NAME, on the robot
  case $1 in
    map_store) start_on robot map_store map_store --out "/exchange/$run" --title log.clf ;;
    sensor_gateway) start_on robot sensor_gateway sensor_gateway --log /exchange/log.clf --rate "${rate:-lossless}" ;;
    localizer) start_on robot localizer localizer --replay --wait-workers "${workers:-2}" --wait-seconds "$hang_limit_s" ;;
    local_mapper) start_on robot local_mapper local_mapper --replay ;;
    *) start_on robot "$1" "$1" ;;
  esac
}

# start_mapping RUN: starts all services of the robot; the results are written to $work/RUN.
start_mapping() {
  run=$1
  local service
  for service in map_store localizer local_mapper planner sensor_gateway; do start_service $service; done
}

# wait_for_map: waits for the results of start_mapping.
wait_for_map() {
  wait_for "the trajectory of run $run" test -e "$work/$run/trajectory.tum" ||
    { tail -n 3 "$work"/log/* >&2; fail "no trajectory"; }
  wait_for "the map of run $run" test -e "$work/$run/map.pb" || fail "no map"
}

stop_mapping() {
  local service
  for service in sensor_gateway local_mapper localizer planner map_store; do kill_on robot $service TERM || true; done
}
