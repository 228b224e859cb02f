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

# In the time of the robot the log takes longer than what happens meanwhile, on a busy machine, too.
step "each service killed and started again"
rate=1 start_mapping killed
eventually 30 test -e "$work/killed/map.sqlite"
for victim in sensor_gateway local_mapper localizer map_store planner; do
  sleep 1
  [ ! -e "$work/killed/map.pb" ] || fail "the log ended before $victim was killed"
  kill_on robot $victim
  rate=1 start_service $victim
  step "$victim"
done
lose_host pc1
[ ! -e "$work/killed/map.pb" ] || fail "the log ended before the host of a worker was lost"
start_host pc1
start_worker pc1
step "the host of a worker"
lose_host robot
[ ! -e "$work/killed/map.pb" ] || fail "the log ended before the robot was lost"
start_host robot
start_mapping killed
step "the robot"
wait_for_map 120
same_results "$work/killed" "$work/alone"
stop_mapping

step "a host that joins late"
kill_on pc1 ga_worker TERM
kill_on pc2 ga_worker TERM
# It listens before the host joins: a `topogeo workers` listens for more than a second before it lists any.
start_on robot watch topogeo workers --watch
workers=0 rate=1 start_mapping late
eventually 30 test -e "$work/late/map.sqlite"
eventually 30 test -s "$work/log/robot.watch" || fail "topogeo workers --watch lists nothing"
joined=$(date +%s%N)
start_worker pc2
late_worked() { [ "$(count_workers 1 < "$work/log/robot.watch")" -ge 1 ]; }
until late_worked; do
  [ $(($(date +%s%N) - joined)) -lt 30000000000 ] || fail "the late host got no work"
  sleep 0.02
done
# A worker reports twice a second, and is listed twice a second.
step "the late host is listed with a task done $((($(date +%s%N) - joined) / 1000000)) ms after its start, up to 1000 ms late"
kill_on robot watch TERM
[ ! -e "$work/late/map.pb" ] || fail "the log ended before the late host had work"
# The rest without waiting for the time of the robot.
kill_on robot sensor_gateway
start_service sensor_gateway
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

step "it comes back, and the other one dies"
kill_on pc2 ga_worker TERM
start_on pc1 server fast-discovery-server -i 0 -l 0.0.0.0 -p 11811
kill_on pc2 server
# The services that ran all the time, and a worker that they have not met before.
all_well() { on robot topogeo status --expect sensor_gateway,local_mapper,localizer,map_store,planner > /dev/null; }
start_worker pc2
eventually 60 one_worker || fail "no worker is found with the server that came back"
eventually 30 all_well || { on robot topogeo status; fail "a service is lost"; }

step "health"
on robot health || fail "a host with all services is not healthy"
stop_mapping
if on robot health; then fail "a host without services is healthy"; fi
step "the end"
