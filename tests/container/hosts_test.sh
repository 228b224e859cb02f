#!/usr/bin/env bash
# A robot and search workers on other hosts: the map of a log equals that of one process to the byte, also when services
# are killed and restarted and when a host joins late; discovery by two servers without multicast.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
source "$(dirname "${BASH_SOURCE[0]}")/hosts.sh"

need_image
map_alone 150 "$work/alone"
chmod 777 "$work"
make_network
start_host robot
start_host pc1
start_host pc2

step "a log with workers on two other hosts"
start_worker pc1
start_worker pc2
start_mapping plain
wait_for_map
both_worked() { [ "$(workers_done)" = 2 ]; }
wait_for "work of both workers" both_worked || fail "$(workers_done) of 2 workers had work"
same_results "$work/plain" "$work/alone"
stop_mapping

has_ended() { [ -e "$work/$run/map.pb" ]; }
# When the log ends before all of this is done, the run is repeated at half the speed.
lose_all() {
  local victim stops
  for victim in sensor_gateway local_mapper localizer map_store planner; do
    stops=$(stops_stored)
    wait_for "another stop in the map" more_stops_than "$stops" || fail "the map does not grow before $victim is killed"
    ! has_ended || return 1
    kill_on robot $victim || fail "$victim has ended by itself"
    start_service $victim
    step "$victim"
  done
  lose_host pc1
  start_host pc1
  start_worker pc1
  step "the host of a worker"
  ! has_ended || return 1
  lose_host robot
  start_host robot
  ! has_ended
}
step "each service killed and started again"
rate=1
start_mapping killed
until lose_all; do
  stop_mapping
  rate=$(awk -v rate="$rate" 'BEGIN { print rate / 2 }')
  step "the log ended first: again, at $rate times the speed of the robot"
  start_mapping "killed-at-$rate"
done
rate=lossless
start_mapping "$run"
step "the robot"
wait_for_map
same_results "$work/$run" "$work/alone"
stop_mapping

step "a host that joins late"
kill_on pc1 ga_worker TERM
kill_on pc2 ga_worker TERM
late_worked() { [ "$(count_workers 1 < "$work/log/robot.watch")" -ge 1 ] || has_ended; }
# Whether the late host has done work before the log ends.
join_late() {
  # The list starts before the host joins: `topogeo workers` collects for more than a second before it lists any.
  rm -f "$work/log/robot.watch"
  start_on robot watch topogeo workers --watch
  wait_for "the map" test -e "$work/$run/map.sqlite" || fail "no map is begun"
  wait_for "the list of workers" test -s "$work/log/robot.watch" || fail "topogeo workers --watch lists nothing"
  local joined
  joined=$(now_ms)
  start_worker pc2
  wait_for "work of the late host" late_worked || fail "the late host got no work"
  [ "$(count_workers 1 < "$work/log/robot.watch")" -ge 1 ] || return 1
  # A worker reports twice a second, and the list is updated twice a second.
  step "the late host is listed with a task done $(($(now_ms) - joined)) ms after its start, up to 1200 ms late"
}
export workers=0
rate=1
start_mapping late
until join_late; do
  kill_on robot watch TERM
  kill_on pc2 ga_worker TERM
  stop_mapping
  rate=$(awk -v rate="$rate" 'BEGIN { print rate / 2 }')
  step "the log ended first: again, at $rate times the speed of the robot"
  start_mapping "late-at-$rate"
done
kill_on robot watch TERM
# The rest runs without waiting for real time.
kill_on robot sensor_gateway
rate=lossless
start_service sensor_gateway
wait_for_map
same_results "$work/$run" "$work/alone"
stop_mapping
kill_on pc2 ga_worker TERM

step "discovery by servers, multicast off"
for host in robot pc1 pc2; do no_multicast_on $host; done
start_worker pc1
# Its repeated announcements are dropped.
wait_for "announcements of the worker that are dropped" has_dropped_on pc1 3 || fail "the worker does not announce itself"
[ "$(workers_there)" = 0 ] || fail "multicast is not off: a worker was found without a server"
kill_on pc1 ga_worker
docker rm -f "$network-robot" "$network-pc1" "$network-pc2" > /dev/null
servers='pc1:11811;pc2:11811'
for host in robot pc1 pc2; do start_host $host -e ROS_DISCOVERY_SERVER="$servers"; done
for host in robot pc1 pc2; do no_multicast_on $host; done
start_on pc1 server fast-discovery-server -i 0 -l 0.0.0.0 -p 11811
start_on pc2 server fast-discovery-server -i 1 -l 0.0.0.0 -p 11811
start_worker pc1
start_worker pc2
workers=2
rate=20
start_mapping discovered
wait_for_map
same_results "$work/discovered" "$work/alone"
step "one of the two servers dies"
kill_on pc1 server
stop_mapping
kill_on pc2 ga_worker TERM
start_worker pc2
one_worker() { [ "$(workers_there)" -ge 1 ]; }
wait_for "a worker, with one server" one_worker || fail "no worker is found with one server"
rate=lossless
start_mapping one_server
wait_for_map
same_results "$work/one_server" "$work/alone"

step "it comes back, and the other one dies"
kill_on pc2 ga_worker TERM
start_on pc1 server fast-discovery-server -i 0 -l 0.0.0.0 -p 11811
kill_on pc2 server
# The services that ran all the time, and a worker that is new to them.
all_well() { on robot topogeo status --expect sensor_gateway,local_mapper,localizer,map_store,planner > /dev/null; }
start_worker pc2
wait_for "a worker, with the server that came back" one_worker || fail "no worker is found with the server that came back"
wait_for "all services" all_well || { on robot topogeo status; fail "a service is lost"; }

step "health"
on robot health || fail "a host with all services is not healthy"
stop_mapping
if on robot health; then fail "a host without services is healthy"; fi
step "the end"
