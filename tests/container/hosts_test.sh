#!/usr/bin/env bash
# A robot and search workers on other hosts: the map of a log is that of one process to the byte, also when
# services are killed and started again and when a host joins late; discovery by two servers without multicast.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
source "$(dirname "${BASH_SOURCE[0]}")/hosts.sh"

need_image
make_log 150 "$work/log.clf"
"$bin/topogeo" map --log "$work/log.clf" --out "$work/alone" > /dev/null 2>&1
chmod 777 "$work"
make_network
start_host robot
start_host pc1
start_host pc2

step "a log with workers on two other hosts"
start_worker pc1
start_worker pc2
start_mapping plain
wait_for_map 120
both_worked() { [ "$(workers_done)" = 2 ]; }
eventually 20 both_worked || fail "$(workers_done) of 2 workers had work"
same_results "$work/plain" "$work/alone"
stop_mapping

step "each service killed and started again"
rate=5 start_mapping killed
for victim in localizer map_store planner; do
  sleep 1
  [ ! -e "$work/killed/map.pb" ] || fail "the log ended before $victim was killed"
  kill_on robot $victim
  rate=5 start_service $victim
  step "$victim"
done
kill_on pc1 ga_worker
[ ! -e "$work/killed/map.pb" ] || fail "the log ended before the worker was killed"
start_worker pc1
step "ga_worker"
wait_for_map 120
same_results "$work/killed" "$work/alone"
stop_mapping

step "a host that joins late"
kill_on pc1 ga_worker TERM
kill_on pc2 ga_worker TERM
workers=0 rate=5 start_mapping late
eventually 30 test -e "$work/late/map.sqlite"
start_worker pc2
joined=$(date +%s%N)
until [ "$(workers_done)" -ge 1 ]; do
  [ $(($(date +%s%N) - joined)) -lt 30000000000 ] || fail "the late host got no work"
done
step "the late host had done work $((($(date +%s%N) - joined) / 1000000)) ms after its start"
[ ! -e "$work/late/map.pb" ] || fail "the log ended before the late host had work"
wait_for_map 120
same_results "$work/late" "$work/alone"
stop_mapping
kill_on pc2 ga_worker TERM

step "discovery by servers, multicast off"
for host in robot pc1 pc2; do no_multicast_on $host; done
start_worker pc1
sleep 2
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
rate=20 start_mapping discovered
wait_for_map 120
same_results "$work/discovered" "$work/alone"
step "one of the two servers dies"
kill_on pc1 server
stop_mapping
kill_on pc2 ga_worker TERM
start_worker pc2
one_worker() { [ "$(workers_there)" -ge 1 ]; }
eventually 30 one_worker || fail "no worker is found with one server"
start_mapping one_server
wait_for_map 120
same_results "$work/one_server" "$work/alone"

step "health"
on robot health || fail "a host with all services is not healthy"
stop_mapping
if on robot health; then fail "a host without services is healthy"; fi
step "the end"
