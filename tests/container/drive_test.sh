#!/usr/bin/env bash
# A simulated robot drives to "room A" with its services on three hosts, and continues while each service is replaced by
# one from a newer image.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
source "$(dirname "${BASH_SOURCE[0]}")/hosts.sh"

need python3
need_image
chmod 777 "$work"
cat > "$work/places.yaml" <<'YAML'
places:
  - {name: room A, at: [3, 0]}
  - {name: room B, at: [0.4, 0.2]}
YAML
make_network
for host in robot pc1 pc2; do start_host "$host"; done

release=$image

# run HOST SERVICE [OPTIONS]: a container of the release in the network of the host, as in compose.yaml. The robot's
# containers share the pseudo-terminals of the simulator.
run() {
  docker run -d --name "$network-$1-$2" --network "container:$network-$1" --init --no-healthcheck --user root \
    -e TOPOGEO_DOMAIN -e TOPOGEO_LONGEST_FREEZE_S=0 -e TOPOGEO_METRICS_PORT="${metrics:-}" -v "$work:/exchange" -v /dev/pts:/dev/pts "$release" "${@:2}" > /dev/null
  cleanups+=("docker rm -f $network-$1-$2")
}

run_service() {
  case $1 in
    sensor_gateway)
      run robot sensor_gateway --devices /exchange/devices.yaml --laser-port /exchange/laser \
        --base-port /exchange/base --memory /exchange/odometry
      ;;
    local_mapper) run robot local_mapper ;;
    navigator) run robot navigator --memory /exchange/goal ;;
    map_store) run pc1 map_store --out /exchange/map --places /exchange/places.yaml ;;
    ga_worker) run pc2 ga_worker --name pc2 ;;
    *) metrics=9464 run pc1 "$1" ;;
  esac
}

container_of() { docker ps -a --format '{{ .Names }}' | grep -E "^$network-(robot|pc1|pc2)-$1\$"; }

# state SERVICE: its state and message, "-" without a status.
state() {
  on robot topogeo status "$1" --json 2> /dev/null |
    python3 -c 'import json, sys
services = json.load(sys.stdin)
print(services[-1]["state"], services[-1]["message"]) if services else print("-")' || echo -
}
is_in_state() { state "$1" | grep -q "$2"; }
lives() { [ "$(state "$1")" != - ] && ! is_in_state "$1" 'lost\|silent\|failed'; }
show() { docker logs "$(container_of "$1")" 2>&1 | tail -n 15; }
# Shows why the robot stands still: logs of the services that make map and plan.
show_all() {
  local service
  on robot topogeo status
  cat "$work/tour.log"
  for service in local_mapper localizer map_store planner; do printf -- '-- %s\n' $service; show $service; done
}

step "the services of a robot on three hosts"
cp "$source_dir/share/worlds/room.world.yaml" "$work"
run robot simulator --world /exchange/room.world.yaml --laser-port /exchange/laser --base-port /exchange/base
"$bin/topogeo" config --devices > "$work/devices.yaml"
services='sensor_gateway local_mapper localizer map_store planner navigator ga_worker'
for service in $services; do run_service "$service"; done
wait_for "the ports of the simulator" test -L "$work/laser" || { show simulator; fail "the simulator makes no ports"; }
plans() { is_in_state planner '^running' && ! is_in_state planner 'needs'; }
wait_for "a map at the planner" plans || { on robot topogeo status; show sensor_gateway; fail "the planner gets no map"; }

# drive PLACE: drives until the robot has arrived.
drive() {
  wait_for "the robot in $1" arrives on robot topogeo goto "$1" || { on robot topogeo status; fail "the robot does not get to $1"; }
}
drive "room A"
step "the robot is in room A"

step "metrics"
has_metrics() {
  # shellcheck disable=SC2016  # expanded in the container
  on pc1 bash -c 'exec 3<> /dev/tcp/127.0.0.1/9468; printf "GET /metrics HTTP/1.0\r\n\r\n" >&3; cat <&3' \
    > "$work/metrics" 2>&1 && grep -q '^topogeo_service_state{.*planner.*"running".* 1$' "$work/metrics"
}
wait_for "metrics of the planner" has_metrics || { head -n 20 "$work/metrics"; fail "the planner has no metrics"; }

step "each service replaced by one of a newer image"
printf 'FROM %s\nLABEL release=newer\n' "$image" | docker build -q -t "$image-newer" - > /dev/null 2>&1
cleanups+=("docker rmi $image-newer")
release=$image-newer
# `goto` waits at most ten seconds for the navigator; a busy machine may need more to replace it.
may_fail() { [ -e "$work/may_fail" ] || tail -n 1 "$work/tour.log" | grep -q "the navigator is gone"; }
# Drives back and forth until all services are replaced.
(
  trap 'exit 0' TERM
  while :; do
    for place in "room B" "room A"; do
      docker exec "$network-robot" topogeo goto "$place" "${patient[@]}" >> "$work/tour.log" 2>&1 &
      wait $! || may_fail || exit 1
      [ ! -e "$work/replaced" ] || exit 0
    done
  done
) &
tour=$!
cleanups+=("kill $tour")
drives() { is_in_state navigator driving; }
for service in $services; do
  wait_for "the robot to drive" drives || { show_all; fail "the robot stands before another $service"; }
  old=$(container_of "$service")
  docker stop -t "$hang_limit_s" "$old" > /dev/null
  docker rm "$old" > /dev/null
  run_service "$service"
  wait_for "the newer $service" lives "$service" || { show "$service"; fail "the newer $service does not come up"; }
  step "$service"
done
wait_for "the robot to drive" drives || { show_all; fail "the robot stands with newer services"; }
step "the host of localizer, map store and planner is lost on a drive, and comes back"
touch "$work/may_fail"
lose_host pc1
stands() { ! drives; }
wait_for "the robot to stand" stands || fail "the robot drives on without map and pose"
start_host pc1
for service in localizer map_store planner; do run_service $service; done
for service in localizer map_store planner; do
  wait_for "$service on the host that came back" lives $service || { show $service; fail "$service does not come back"; }
done
wait_for "the robot to drive" drives || { show_all; fail "the robot stands after its host came back"; }
touch "$work/replaced"
wait $tour || { tail -n 5 "$work/tour.log"; on robot topogeo status; fail "a drive failed"; }
drive "room A"
step "what the services are"
for service in $services; do
  [ "$(docker inspect -f '{{ index .Config.Labels "release" }}' "$(container_of "$service")")" = newer ] ||
    fail "$service is not of the newer image"
done
# On a busy machine a single check may find a service late with its status.
all_are_well() { on robot topogeo status > "$work/status"; }
wait_for "all services to be well" all_are_well || { cat "$work/status"; fail "not all services are well"; }
count_collisions() {
  collisions=$(on robot topogeo status simulator --json |
    python3 -c 'import json, sys; print(json.load(sys.stdin)[0]["counters"]["collisions"])' 2> /dev/null)
}
wait_for "the collisions of the simulator" count_collisions || fail "the simulator does not say its collisions"
[ "${collisions%.*}" = 0 ] || fail "the robot ran into something $collisions times"
step "the end"
